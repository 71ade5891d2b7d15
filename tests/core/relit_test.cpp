// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes whose lights have other strengths afterwards, against bakes with these strengths.
#include <gtest/gtest.h>

#include "scenes.h"
#include "transport/indirect_shares.h"
#include "whole_passes.h"

namespace leaflight {
namespace {

Progress ignored;

const Rgb first_factor(3, 0.5f, 0), second_factor(0.25f, 2, 7);

// Returns a ball over a floor with an area light, a spot light and a small emissive mesh. The
// arguments scale the lights; zero removes one.
Scene<3> room(const Rgb& first, const Rgb& second, const Rgb& glow) {
  Scene<3> scene = test::scene_of(test::ball<3>(25), Rgb(0.7f, 0.6f, 0.5f), {0.6, 0.9});
  scene.meshes.push_back(
      test::wall("floor", {-0.5, -0.5, -0.2}, {2, 0, 0}, {0, 2, 0}, Rgb(0.8f, 0.5f, 0.3f)));
  scene.meshes.push_back(test::wall("glow", {1.4, 0.4, 0.4}, {0, 0.1, 0}, {0, 0, 0.1}, Rgb(0.5f)));
  scene.meshes.back().emission = glow * Rgb(4.0f);
  scene.lights.push_back(AreaLight<3>{
      "lamp", {0.2, 0.2, 1.5}, {Vec3(0, 0.6, 0), Vec3(0.6, 0, 0)}, Rgb(1, 2, 3) * first});
  PointLight<3> spot{"spot", {-0.6, 0.3, 0.6}, 0.05, Rgb(2, 1, 1) * second, {}};
  spot.cone = {Vec3(1, 0, 0), 0.6, 0.3, false};
  scene.lights.push_back(spot);
  return scene;
}

DirectLight<3> direct_light(const Scene<3>& scene) {
  const SceneTracer<3> tracer(scene);
  return {tracer, 0, split_light(tracer).points, {test::field_of(scene).dims, true}, ignored};
}

template <class F>
void for_some_positions(const Field<3>& field, F f) {
  Random random(3, 1, 4);
  for (int i = 0; i < 500; ++i) {
    Vec3 position;
    for (int a = 0; a < 3; ++a) position[a] = random.uniform() * (field.dims[a] - 1);
    for (const bool back : {false, true}) f(position, back);
  }
}

void expect_equal(const Imath::V3d& found, const Imath::V3d& truth, double scale) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], truth[i], 1e-5 * scale);
}

TEST(Relit, DirectLightIsThatOfTheOtherStrengths) {
  const Scene<3> scene = room(Rgb(1), Rgb(1), Rgb(1));
  const DirectLight<3> found = direct_light(scene).scaled({first_factor, second_factor});
  // Light points depend on positions, so no light may be black here.
  const DirectLight<3> truth = direct_light(room(first_factor, second_factor, Rgb(1)));
  double most = 0;
  for_some_positions(test::field_of(scene), [&](const Vec3& position, bool back) {
    const Rgb expected = truth.radiance(test::field_of(scene), position, back);
    most = std::max<double>(most, largest(expected));
    expect_equal(Imath::V3d(found.radiance(test::field_of(scene), position, back)),
                 Imath::V3d(expected), 1);
  });
  EXPECT_GT(most, 0.1);
}

TEST(Relit, DirectLightAddsUpOverLights) {
  const Scene<3> scene = room(Rgb(1), Rgb(1), Rgb(1));
  const Field<3>& field = test::field_of(scene);
  const DirectLight<3> all = direct_light(scene);
  const DirectLight<3> dark = all.scaled({Rgb(0), Rgb(0)}), first = all.scaled({Rgb(1), Rgb(0)}),
                       second = all.scaled({Rgb(0), Rgb(1)});
  double first_change = 0, second_change = 0, glow_light = 0;
  for_some_positions(field, [&](const Vec3& position, bool back) {
    const Imath::V3d glow(dark.radiance(field, position, back)),
        one(first.radiance(field, position, back)), other(second.radiance(field, position, back));
    first_change = std::max(first_change, (one - glow).length());
    second_change = std::max(second_change, (other - glow).length());
    glow_light = std::max(glow_light, glow.length());
    expect_equal(one + other - glow, Imath::V3d(all.radiance(field, position, back)), 1);
  });
  for (const double most : {first_change, second_change, glow_light}) EXPECT_GT(most, 0.001);
}

TEST(Relit, DirectLightOfMeshesIsThatOfTheOtherStrengths) {
  const auto direct = [](const Scene<3>& scene) {
    return MeshDirectLight<3>(SceneTracer<3>(scene), subdivide(scene), ignored);
  };
  const MeshDirectLight<3> found =
      direct(room(Rgb(1), Rgb(1), Rgb(1))).scaled({first_factor, second_factor});
  const MeshDirectLight<3> truth = direct(room(first_factor, second_factor, Rgb(1)));
  for (const bool back : {false, true}) {
    const auto relit = found.radiance(0, 0.75, back), other = truth.radiance(0, 0.75, back);
    ASSERT_EQ(relit.size(), other.size());
    float most = 0;
    for (std::size_t v = 0; v < relit.size(); ++v) {
      most = std::max(most, other[v].length());
      expect_equal(Imath::V3d(relit[v]), Imath::V3d(other[v]), 1);
    }
    if (!back) {
      EXPECT_GT(most, 0.1);
    }
  }
}

// Use powers of two, so that both scenes take the same branches in floating point.
TEST(Relit, OfOneLampAllLightIsThatOfTheOtherStrength) {
  const auto baked = [](Real brighter) {
    Scene<3> scene = test::small_scene();
    auto& lamp = std::get<AreaLight<3>>(scene.lights[0]);
    lamp.radiance *= brighter;
    BakeSettings<3> settings = test::all_light(17);
    settings.exposure = 1 / brighter;
    return test::baked(scene, settings);
  };
  const Scene<3> scene = test::small_scene();
  const Field<3>& field = test::field_of(scene);
  const Baked<3> original = baked(1), truth = baked(4);
  const std::vector<Rgb> factors{Rgb(4)};
  const Rgb indirect = indirect_shares(SceneTracer<3>(scene)).factor(factors);
  EXPECT_EQ(indirect, Rgb(4));
  const RadianceGrid<3>& grid = original.grids[0];
  const DirectLight<3> direct = grid.direct->scaled(factors);
  const ShownGrid<3> shown(grid, &direct, Vec<3, float>(indirect));
  for (const bool back : {false, true}) {
    if (back && !grid.has_back()) continue;
    for (const std::uint32_t texel : grid.lattice.active) {
      const Vec3 position = grid.lattice.center(texel);
      const Imath::V3d expected(radiance_at(truth.grids[0], field, position, back));
      expect_equal(Imath::V3d(radiance_at(shown, field, position, back)), expected,
                   1 + expected.length());
    }
  }
  if (test::sanitized) return;
  const auto walls = relit(original.walls, scene.meshes, factors, Vec<3, float>(indirect));
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto found = radiance_at(walls, static_cast<int>(m), 0.75, false),
               expected = radiance_at(truth.walls, static_cast<int>(m), 0.75, false);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t v = 0; v < found.size(); ++v) {
      expect_equal(Imath::V3d(found[v]), Imath::V3d(expected[v]), 1 + expected[v].length());
    }
  }
}

TEST(Relit, IndirectLightGrowsWithWhatComesBack) {
  Scene<3> scene = test::small_scene();
  // Put two lights at one place, with equal power in red and three times the power in green.
  const Vec3 place(0.1, 0.1, 1.1);
  scene.lights = {PointLight<3>{"first", place, 0, Rgb(1, 1, 0), {}},
                  PointLight<3>{"second", place, 0, Rgb(1, 3, 0), {}}};
  const auto factor = [&](const std::vector<Rgb>& lights) {
    return Imath::V3d(indirect_shares(SceneTracer<3>(scene)).factor(lights));
  };
  expect_equal(factor({Rgb(3), Rgb(1)}), {2, 1.5, 2}, 1);
  expect_equal(factor({Rgb(0), Rgb(0)}), {0, 0, 0}, 1);
  // A light behind the back wall lights nothing visible.
  scene.lights.emplace_back(PointLight<3>{"hidden", {0.5, 3, 0.5}, 0, Rgb(50), {}});
  expect_equal(factor({Rgb(1), Rgb(1), Rgb(100)}), {1, 1, 34}, 1);
  scene.lights.pop_back();
  // Another emitter keeps its strength.
  scene.environment = Environment<3>{"world", Rgb(0.2f), nullptr, test::unit_cube<3>(2)};
  const Imath::V3d dark = factor({Rgb(0), Rgb(0)}), double_light = factor({Rgb(2), Rgb(2)});
  EXPECT_EQ(dark.z, 1);
  for (const int i : {0, 1}) {
    EXPECT_GT(dark[i], 0);
    EXPECT_LT(dark[i], 1);
    EXPECT_NEAR(double_light[i] - 1, 1 - dark[i], 1e-6);
  }
  EXPECT_GT(dark.x, dark.y);
}

// An emissive isosurface keeps its own emission, while all light of lamps is scaled.
TEST(Relit, OwnEmissionStays) {
  Scene<3> scene = test::small_scene();
  const Field<3>& field = test::field_of(scene);
  const Rgb glow(0.5f, 0.25f, 1);
  scene.volumes[0].emission = ColorRamp(glow);
  const Baked<3> baked = test::baked(scene, test::all_light(17));
  const RadianceGrid<3>& grid = baked.grids[0];
  const std::vector<Rgb> factors{Rgb(0)};
  const DirectLight<3> direct = grid.direct->scaled(factors);
  const ShownGrid<3> alone(grid, &direct, Vec<3, float>(0)),
      half(grid, &direct, Vec<3, float>(0.5f)), all(grid, &direct, Vec<3, float>(1));
  double most = 0;
  for (const std::uint32_t texel : grid.lattice.active) {
    const Vec3 position = grid.lattice.center(texel);
    const Imath::V3d emission(radiance_at(alone, field, position, false)),
        some(radiance_at(half, field, position, false)),
        whole(radiance_at(all, field, position, false));
    expect_equal(emission, Imath::V3d(glow), 1);
    expect_equal(some, (emission + whole) * 0.5, 1);
    most = std::max(most, (whole - emission).length());
  }
  EXPECT_GT(most, 0.01);
}

}  // namespace
}  // namespace leaflight
