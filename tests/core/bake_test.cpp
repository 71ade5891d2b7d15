// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <gtest/gtest.h>

#include "bake/output/atlas.h"
#include "base/error.h"
#include "scenes.h"

namespace leaflight {
namespace {

BakeSettings<3> quick() {
  BakeSettings<3> settings;
  settings.error = 20;
  return settings;
}

Scene<3> small_scene() { return test::cornell(test::ball<3>(25), {0.6, 0.9}); }

TEST(Bake, ReportsProgress) {
  Progress progress;
  EXPECT_EQ(progress.fraction(), 0);
  bake(small_scene(), quick(), progress);
  EXPECT_GT(progress.fraction(), 0.5);
  EXPECT_FALSE(progress.stage().empty());
}

TEST(Bake, StoresOnlyTexelsThatAnIsosurfaceReaches) {
  const Scene<3> scene = test::cornell(test::ball<3>(49), {0.85, 0.9});
  Progress progress;
  const RadianceGrid<3> grid = bake(scene, quick(), progress).grids[0];
  EXPECT_GT(grid.lattice.active.size(), 200u);
  EXPECT_LT(grid.lattice.active.size(), grid.lattice.texels() / 20);
}

TEST(Bake, OtherResolutionsThanTheField) {
  const Scene<3> scene = small_scene();
  for (const Index<3>& resolution : {Index<3>{13, 17, 40}, Index<3>{49, 49, 49}}) {
    BakeSettings<3> settings = quick();
    settings.resolution = resolution;
    Progress progress;
    const RadianceGrid<3> grid = bake(scene, settings, progress).grids[0];
    EXPECT_EQ(grid.lattice.resolution, resolution);
    // Look up the top of the ball, in index coordinates. The lamp is above it.
    EXPECT_GT(lookup(grid.lattice, all_light(grid, test::field_of(scene), false),
                     {12, 12, 12 + 24 * 0.28})
                  .y,
              0.3);
  }
}

AreaLight<3>& lamp(Scene<3>& scene) { return std::get<AreaLight<3>>(scene.lights[0]); }

// Returns the error message of a bake of the scene; empty if there is no error.
std::string message(const Scene<3>& scene) {
  Progress progress;
  try {
    bake(scene, quick(), progress);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Bake, RefusesBadScenes) {
  Scene<3> scene = small_scene();
  scene.lights.clear();
  EXPECT_NE(message(scene).find("no light"), std::string::npos);
  scene = small_scene();
  lamp(scene).edges[0] = Vec3(0.0);
  EXPECT_NE(message(scene).find("'lamp' has no area"), std::string::npos);
  scene = small_scene();
  lamp(scene).radiance = Rgb(-1);
  EXPECT_NE(message(scene).find("'lamp'"), std::string::npos);
  scene = small_scene();
  scene.meshes[2].albedo = Rgb(1.5f);
  EXPECT_NE(message(scene).find("wall 3"), std::string::npos);
  scene = small_scene();
  scene.meshes[0].vertices[1].x = std::nanf("");
  EXPECT_NE(message(scene).find("wall 0"), std::string::npos);
  scene = small_scene();
  scene.meshes[0].facets[0][0] = 99;
  EXPECT_NE(message(scene).find("vertex 99"), std::string::npos);
  scene = small_scene();
  scene.isovalue_range = {0.9, 0.6};
  EXPECT_NE(message(scene).find("is empty"), std::string::npos);
  scene = small_scene();
  scene.isovalue_range = {2, 3};
  EXPECT_NE(message(scene).find("outside the data"), std::string::npos);
  scene = small_scene();
  scene.meshes[0].facets.clear();
  EXPECT_NE(message(scene).find("no faces in the mesh 'wall 0'"), std::string::npos);
  scene = small_scene();
  scene.lights = {PointLight<3>{"bulb", Vec3(0, 0, 2), -1, Rgb(1), {}}};
  EXPECT_NE(message(scene).find("'bulb' has a negative radius"), std::string::npos);
  scene.lights = {PointLight<3>{"bulb", Vec3(0, 0, 2), 0, Rgb(-1), {}}};
  EXPECT_NE(message(scene).find("'bulb' has a negative"), std::string::npos);
  scene.lights = {SunLight<3>{"sun", Vec3(0, 0, 2), Rgb(1), 0}};
  EXPECT_NE(message(scene).find("'sun' has a direction"), std::string::npos);
  scene = small_scene();
  scene.volumes[0].emission = ColorRamp({{0.9, Rgb(1)}, {0.6, Rgb(0)}});
  EXPECT_NE(message(scene).find("ramp of the volume"), std::string::npos);
}

TEST(Bake, RefusesObjectsInTheWrongPlace) {
  // The whole room is one mesh around the lamp and the volume, which is valid.
  Scene<3> scene = small_scene();
  Mesh<3> room;
  room.name = "room";
  room.albedo = Rgb(0.5f);
  for (const test::Side& side : test::cube_sides(-0.3, 1.3)) {
    const Mesh<3> wall = test::wall("wall", side.corner, side.u, side.v, Rgb(0.5f));
    const auto first = static_cast<std::uint32_t>(room.vertices.size());
    room.vertices.insert(room.vertices.end(), wall.vertices.begin(), wall.vertices.end());
    for (const auto& f : wall.facets) {
      room.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
    }
  }
  scene.meshes = {room};
  EXPECT_EQ(message(scene), "");
  // Put the lamp inside a thick ceiling.
  Mesh<3> block = room;
  block.name = "ceiling";
  for (auto& v : block.vertices) {
    v = Vec<3, float>(v.x, v.y, v.z < 0 ? 1.25f : 1.45f);
  }
  scene.meshes = {block};
  EXPECT_NE(message(scene).find("'lamp' stands inside the mesh 'ceiling'"), std::string::npos);
  // Put a room with the lamp elsewhere.
  scene.meshes = {room};
  for (auto& v : scene.meshes[0].vertices) v.x += 10;
  lamp(scene).corner.x += 10;
  EXPECT_NE(message(scene).find("stands inside the mesh 'room'"), std::string::npos);
  // Do the same with separate walls.
  scene = small_scene();
  scene.volumes[0].name = "brain";
  for (Mesh<3>& mesh : scene.meshes) {
    for (auto& v : mesh.vertices) v.x += 10;
  }
  lamp(scene).corner.x += 10;
  EXPECT_NE(message(scene).find("The volume 'brain' lies outside the walls"), std::string::npos);
  scene.lights.push_back(SunLight<3>{"sun", Vec3(0, 0, -1), Rgb(1), 0});
  EXPECT_EQ(message(scene), "") << "lit outside the room";
}

TEST(Atlas, HoldsTheTexels) {
  Progress progress;
  const Scene<3> scene = small_scene();
  const RadianceGrid<3> grid = bake(scene, quick(), progress).grids[0];
  const auto light = all_light(grid, test::field_of(scene), false);
  const Atlas atlas = make_atlas(grid.lattice, light);
  const Index<3>& n = grid.lattice.resolution;
  EXPECT_EQ(atlas.width, atlas.columns * n[0]);
  EXPECT_EQ(atlas.height, atlas.rows * n[1]);
  EXPECT_GE(atlas.columns * atlas.rows, n[2]);
  for (std::size_t s = 0; s < grid.lattice.active.size(); ++s) {
    const Index<3> t = grid.lattice.texel(grid.lattice.active[s]);
    const int column = (t[2] % atlas.columns) * n[0] + t[0];
    const int row = (t[2] / atlas.columns) * n[1] + t[1];
    const float* pixel = &atlas.pixels[4 * (static_cast<std::size_t>(row) * atlas.width + column)];
    ASSERT_EQ(pixel[0], light[s].x);
    ASSERT_EQ(pixel[2], light[s].z);
  }
}

}  // namespace
}  // namespace leaflight
