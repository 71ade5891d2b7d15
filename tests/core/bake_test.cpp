// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <gtest/gtest.h>

#include <cstring>

#include "bake/output/atlas.h"
#include "cancelling.h"
#include "math/error.h"
#include "scenes.h"

namespace leaflight {
namespace {

BakeSettings<3> quick() {
  BakeSettings<3> settings;
  settings.samples = 4;
  settings.photons = 50'000;
  return settings;
}

Scene<3> small_scene() { return test::cornell(test::ball<3>(25), {0.6, 0.9}); }

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()),
                     a.size() * sizeof(T)) == 0;
}

bool same_bits(const Baked<3>& bake_a, const Baked<3>& bake_b) {
  const RadianceGrid<3>&a = bake_a.grids[0], &b = bake_b.grids[0];
  return a.lattice.active == b.lattice.active && same_bits(a.radiance, b.radiance) &&
         same_bits(a.radiance_indirect, b.radiance_indirect) &&
         same_bits(a.radiance_error, b.radiance_error);
}

TEST(Bake, IsTheSameForAnyNumberOfThreads) {
  const Scene<3> scene = small_scene();
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    BakeSettings<3> settings = quick();
    settings.estimator = estimator;
    std::vector<Baked<3>> bakes;
    for (const int threads : {1, 2, 5}) {
      settings.threads = threads;
      Progress progress;
      bakes.push_back(bake(scene, settings, progress));
      EXPECT_EQ(bakes.back().statistics.rays, bakes.front().statistics.rays);
    }
    EXPECT_TRUE(same_bits(bakes[0], bakes[1]));
    EXPECT_TRUE(same_bits(bakes[0], bakes[2]));
  }
}

TEST(Bake, DependsOnTheSeed) {
  const Scene<3> scene = small_scene();
  BakeSettings<3> settings = quick();
  Progress first, second;
  const Baked<3> a = bake(scene, settings, first);
  settings.seed = 1;
  const Baked<3> b = bake(scene, settings, second);
  EXPECT_FALSE(same_bits(a, b));
}

double seconds_to_cancel_a_bake(EstimatorName estimator) {
  const Scene<3> scene = test::cornell(test::ball<3>(65), {0.3, 0.9});
  BakeSettings<3> settings = quick();
  settings.samples = 4096;  // some ten minutes
  settings.estimator = estimator;
  return test::seconds_to_cancel([&](Progress& progress) { bake(scene, settings, progress); });
}

TEST(Bake, IsCancelled) {
  seconds_to_cancel_a_bake(EstimatorName::gather);
  seconds_to_cancel_a_bake(EstimatorName::path);
}

TEST(Bake, IsCancelledWithinHalfASecond) {
  EXPECT_LT(seconds_to_cancel_a_bake(EstimatorName::gather), 0.5);
  EXPECT_LT(seconds_to_cancel_a_bake(EstimatorName::path), 0.5);
}

TEST(Bake, ReportsProgress) {
  Progress progress;
  EXPECT_EQ(progress.fraction(), 0);
  bake(small_scene(), quick(), progress);
  EXPECT_GT(progress.fraction(), 0.5);
  EXPECT_FALSE(progress.stage().empty());
}

TEST(Bake, StoresOnlyTexelsThatALeafReaches) {
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
    settings.samples = 32;
    settings.resolution = resolution;
    Progress progress;
    const RadianceGrid<3> grid = bake(scene, settings, progress).grids[0];
    EXPECT_EQ(grid.lattice.resolution, resolution);
    // The top of the ball, in index coordinates of the field: lit by the lamp above it.
    EXPECT_GT(lookup(grid.lattice, grid.radiance, {12, 12, 12 + 24 * 0.28}).y, 0.3);
  }
}

Plan plan_for(const Scene<3>& scene, EstimatorName estimator) {
  BakeSettings<3> settings;
  settings.estimator = estimator;
  return make_plan(scene, settings);
}

TEST(Plan, SaysWhatItSkipsAndWhy) {
  Scene<3> scene = small_scene();
  const Plan all = plan_for(scene, EstimatorName::gather);
  std::vector<std::string> skipped;
  for (const SkippedPass& pass : all.skipped) skipped.push_back(pass.pass);
  const std::vector<std::string> expected{"specular light", "caustics",
                                          "radiance of the surroundings", "inner side",
                                          "radiance of the inner side"};
  EXPECT_EQ(skipped, expected);
  EXPECT_FALSE(all.inner_side);

  const Plan path = plan_for(scene, EstimatorName::path);
  EXPECT_FALSE(path.photons);
  EXPECT_TRUE(path.indirect);

  scene.meshes.clear();
  EXPECT_FALSE(plan_for(scene, EstimatorName::gather).surroundings_cache);
  EXPECT_TRUE(plan_for(scene, EstimatorName::gather).photons);

  scene.volumes[0].albedo = Rgb(0);
  const Plan black = plan_for(scene, EstimatorName::gather);
  EXPECT_FALSE(black.indirect);
  EXPECT_FALSE(black.photons);
  EXPECT_EQ(black.skipped.size(), 8u);
}

TEST(Plan, InnerSideIsNeededWhereALeafIsOpen) {
  Scene<3> open = small_scene();
  open.window = {0.1, 0.9};  // the lowest leaves meet the border of the domain
  EXPECT_TRUE(plan_for(open, EstimatorName::gather).inner_side);
  Scene<3> lit_inside = small_scene();
  lit_inside.lights.push_back(
      AreaLight<3>{"inner lamp", {0.5, 0.5, 0.5}, {Vec3(0.1, 0, 0), Vec3(0, 0.1, 0)}, Rgb(1)});
  EXPECT_TRUE(plan_for(lit_inside, EstimatorName::gather).inner_side);
}

// A lamp reaches with an edge of its box into a domain that lies askew; the lowest and highest
// corners of the box are beside it.
TEST(Plan, InnerSideIsNeededWhereALampReachesIn) {
  Scene<3> scene = small_scene();
  Affine<3> askew;
  const double s = std::sqrt(0.5) / 24;
  askew.column = {Vec3(s, s, 0), Vec3(-s, s, 0), Vec3(0, 0, 1.0 / 24)};
  Field<3>& domain = scene.volumes[0].field;
  domain = make_field(domain.values, domain.dims, askew, domain.owner);
  PointLight<3> lamp;
  lamp.radius = 0.5;
  for (const double y : {0.0, -1.5}) {
    lamp.position = Vec3(0.5, y, 0.5);
    scene.lights = {lamp};
    EXPECT_EQ(plan_for(scene, EstimatorName::gather).inner_side, y == 0) << y;
  }
}

TEST(Plan, ForcingASkippedPassChangesNothing) {
  const Scene<3> scene = small_scene();
  Plan forced = plan_for(scene, EstimatorName::gather);
  forced.inner_side = true;
  Progress first, second;
  EXPECT_TRUE(same_bits(bake(scene, quick(), first), bake(scene, quick(), forced, second)));
}

AreaLight<3>& lamp(Scene<3>& scene) { return std::get<AreaLight<3>>(scene.lights[0]); }

// What a bake says of a bad scene; empty if it is good.
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
  scene.window = {0.9, 0.6};
  EXPECT_NE(message(scene).find("is empty"), std::string::npos);
  scene = small_scene();
  scene.window = {2, 3};
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
  // The whole room as one mesh encloses lamp and volume alike: nothing is wrong.
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
  // A lamp within a thick ceiling.
  Mesh<3> block = room;
  block.name = "ceiling";
  for (auto& v : block.vertices) {
    v = Vec<3, float>(v.x, v.y, v.z < 0 ? 1.25f : 1.45f);
  }
  scene.meshes = {block};
  EXPECT_NE(message(scene).find("'lamp' stands inside the mesh 'ceiling'"), std::string::npos);
  // A room elsewhere, with its lamp.
  scene.meshes = {room};
  for (auto& v : scene.meshes[0].vertices) v.x += 10;
  lamp(scene).corner.x += 10;
  EXPECT_NE(message(scene).find("stands inside the mesh 'room'"), std::string::npos);
  // The same as separate walls.
  scene = small_scene();
  scene.volumes[0].name = "brain";
  for (Mesh<3>& mesh : scene.meshes) {
    for (auto& v : mesh.vertices) v.x += 10;
  }
  lamp(scene).corner.x += 10;
  EXPECT_NE(message(scene).find("The volume 'brain' lies outside the surroundings"),
            std::string::npos);
  scene.lights.push_back(SunLight<3>{"sun", Vec3(0, 0, -1), Rgb(1), 0});
  EXPECT_EQ(message(scene), "") << "lit outside the room";
}

TEST(Atlas, HoldsTheTexels) {
  Progress progress;
  const RadianceGrid<3> grid = bake(small_scene(), quick(), progress).grids[0];
  const Atlas atlas = make_atlas(grid.lattice, grid.radiance);
  const Index<3>& n = grid.lattice.resolution;
  EXPECT_EQ(atlas.width, atlas.columns * n[0]);
  EXPECT_EQ(atlas.height, atlas.rows * n[1]);
  EXPECT_GE(atlas.columns * atlas.rows, n[2]);
  for (std::size_t s = 0; s < grid.lattice.active.size(); ++s) {
    const Index<3> t = grid.lattice.texel(grid.lattice.active[s]);
    const int column = (t[2] % atlas.columns) * n[0] + t[0];
    const int row = (t[2] / atlas.columns) * n[1] + t[1];
    const float* pixel = &atlas.pixels[4 * (static_cast<std::size_t>(row) * atlas.width + column)];
    ASSERT_EQ(pixel[0], grid.radiance[s].x);
    ASSERT_EQ(pixel[2], grid.radiance[s].z);
  }
}

}  // namespace
}  // namespace leaflight
