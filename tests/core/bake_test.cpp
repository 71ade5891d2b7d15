// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <gtest/gtest.h>

#include "bake/output/atlas.h"
#include "errors.h"
#include "scenes.h"

namespace leaflight {
namespace {

BakeSettings<3> quick() {
  BakeSettings<3> settings;
  settings.error = 20;
  return settings;
}

Scene<3> small_scene() { return test::cornell(test::ball<3>(25), {0.6, 0.9}); }

TEST(Bake, StoresOnlyTexelsThatAnIsosurfaceReaches) {
  const Scene<3> scene = test::cornell(test::ball<3>(49), {0.85, 0.9});
  const RadianceGrid<3> grid = test::baked(scene, quick()).grids[0];
  EXPECT_GT(grid.lattice.active.size(), 200u);
  EXPECT_LT(grid.lattice.active.size(), grid.lattice.texels() / 20);
}

TEST(Bake, OtherResolutionsThanTheField) {
  const Scene<3> scene = small_scene();
  for (const Index<3>& resolution : {Index<3>{13, 17, 40}, Index<3>{49, 49, 49}}) {
    BakeSettings<3> settings = quick();
    settings.resolution = resolution;
    const RadianceGrid<3> grid = test::baked(scene, settings).grids[0];
    EXPECT_EQ(grid.lattice.resolution, resolution);
    // Look up the top of the ball, in index coordinates. The lamp is above it.
    EXPECT_GT(lookup(test::field_of(scene), grid.lattice,
                     all_light(grid, test::field_of(scene), false), {12, 12, 12 + 24 * 0.28})
                  .y,
              0.3);
  }
}

AreaLight<3>& lamp(Scene<3>& scene) { return std::get<AreaLight<3>>(scene.lights[0]); }

void expect_refused(const std::string& words, const Scene<3>& scene) {
  test::expect_refused(words, [&] { test::baked(scene, quick()); });
}

TEST(Bake, RefusesBadScenes) {
  const auto bulb = [](double radius, float intensity) {
    return PointLight<3>{"bulb", Vec3(0, 0, 2), radius, Rgb(intensity), {}};
  };
  const SunLight<3> sun{"sun", Vec3(0, 0, 2), Rgb(1), 0};
  const IsovalueRange empty{0.9, 0.6}, outside{2, 3};
  const ColorRamp descending({{0.9, Rgb(1)}, {0.6, Rgb(0)}});
  const std::pair<const char*, std::function<void(Scene<3>&)>> cases[] = {
      {"no light", [](auto& s) { s.lights.clear(); }},
      {"'lamp' has no area", [](auto& s) { lamp(s).edges[0] = Vec3(0.0); }},
      {"'lamp'", [](auto& s) { lamp(s).radiance = Rgb(-1); }},
      {"wall 3", [](auto& s) { s.meshes[2].albedo = Rgb(1.5f); }},
      {"wall 0", [](auto& s) { s.meshes[0].vertices[1].x = std::nanf(""); }},
      {"vertex 99", [](auto& s) { s.meshes[0].facets[0][0] = 99; }},
      {"is empty", [&](auto& s) { s.isovalue_range = empty; }},
      {"outside the data", [&](auto& s) { s.isovalue_range = outside; }},
      {"no faces in the mesh 'wall 0'", [](auto& s) { s.meshes[0].facets.clear(); }},
      {"'bulb' has a negative radius", [&](auto& s) { s.lights = {bulb(-1, 1)}; }},
      {"'bulb' has a negative", [&](auto& s) { s.lights = {bulb(0, -1)}; }},
      {"'sun' has a direction", [&](auto& s) { s.lights = {sun}; }},
      {"ramp of the volume", [&](auto& s) { s.volumes[0].emission = descending; }},
  };
  for (const auto& [words, spoil] : cases) {
    Scene<3> scene = small_scene();
    spoil(scene);
    expect_refused(words, scene);
  }
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
  EXPECT_NO_THROW(test::baked(scene, quick()));
  // Put the lamp inside a thick ceiling.
  Mesh<3> block = room;
  block.name = "ceiling";
  for (auto& v : block.vertices) {
    v = Vec<3, float>(v.x, v.y, v.z < 0 ? 1.25f : 1.45f);
  }
  scene.meshes = {block};
  expect_refused("'lamp' stands inside the mesh 'ceiling'", scene);
  // Put a room with the lamp elsewhere.
  scene.meshes = {room};
  for (auto& v : scene.meshes[0].vertices) v.x += 10;
  lamp(scene).corner.x += 10;
  expect_refused("stands inside the mesh 'room'", scene);
  // Do the same with separate walls.
  scene = small_scene();
  scene.volumes[0].name = "brain";
  for (Mesh<3>& mesh : scene.meshes) {
    for (auto& v : mesh.vertices) v.x += 10;
  }
  lamp(scene).corner.x += 10;
  expect_refused("The volume 'brain' lies outside the walls", scene);
  scene.lights.push_back(SunLight<3>{"sun", Vec3(0, 0, -1), Rgb(1), 0});
  EXPECT_NO_THROW(test::baked(scene, quick())) << "lit outside the room";
}

TEST(Atlas, HoldsTheTexels) {
  const Scene<3> scene = small_scene();
  const RadianceGrid<3> grid = test::baked(scene, quick()).grids[0];
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
