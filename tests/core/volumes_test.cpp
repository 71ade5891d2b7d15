// SPDX-License-Identifier: GPL-3.0-or-later
// Tests several volumes, emissive and colored isosurfaces, both sides, and walls for each isovalue.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "base/error.h"
#include "scenes.h"

namespace leaflight {
namespace {

Progress ignored;

// Returns two balls in fields of different ranges: c = 0.1 is h = 10 in the second.
Scene<3> two_balls() {
  Scene<3> scene = test::cornell(test::ball<3>(41, Vec3(0.3, 0.5, 0.5)), {0.7, 0.9});
  Volume<3> second;
  second.name = "second";
  second.field = test::sampled<3>(
      33, [](const Vec3& x) { return 100 * (1 - (x - Vec3(0.75, 0.5, 0.45)).length()) + 5; });
  second.albedo = Rgb(0.9f, 0.5f, 0.1f);
  second.offset = 5;
  second.scale = 100;
  scene.volumes[0].name = "first";
  scene.volumes.push_back(second);
  return scene;
}

// Compares one side of a baked volume with path tracing at points of its isosurface.
test::Agreement side_agreement(const Scene<3>& scene, const Baked<3>& baked, int volume, bool back,
                               double c) {
  const Field<3>& field = scene.volumes[volume].field;
  const std::vector<Vec3> points =
      test::isosurface_points(field, scene.volumes[volume].isovalue(c), 17);
  ReferenceSettings settings = test::reference_settings(c, test::fewer(1024), 5);
  settings.volume = volume;
  settings.back = back;
  const auto reference = reference_radiance(scene, points, settings, ignored);
  const RadianceGrid<3>& grid = baked.grids[volume];
  return test::compare(points.size(), reference, [&](std::size_t i) {
    return lookup(field, grid.lattice, back ? grid.radiance_back : grid.radiance,
                  field.world_to_index.point(points[i]));
  });
}

TEST(Volumes, OfOneSceneSeeEachOther) {
  const Scene<3> scene = two_balls();
  for (const EstimatorName estimator : {EstimatorName::gather, EstimatorName::volumetric}) {
    const auto settings =
        test::fixed_settings<3>(estimator, test::fewer(64), test::fewer(4'000'000));
    const Baked<3> baked = test::baked(scene, settings);
    ASSERT_EQ(baked.grids.size(), 2u);
    for (const int volume : {0, 1}) {
      SCOPED_TRACE(volume);
      const test::Agreement found = side_agreement(scene, baked, volume, false, 0.8);
      if (test::sanitized) continue;
      EXPECT_NEAR(found.mean_ratio, 1, 0.01);
      EXPECT_LT(found.relative_rms, 0.08);
    }
  }
  // Without the second ball, the first is brighter in the former shadow.
  Scene<3> alone = two_balls();
  alone.volumes.pop_back();
  const std::vector<Vec3> points = test::isosurface_points(alone.volumes[0].field, 0.8, 17);
  const double before = test::mean_of(test::traced(scene, points, 0.8, 256, 1));
  EXPECT_GT(std::abs(test::mean_of(test::traced(alone, points, 0.8, 256, 1)) / before - 1), 0.005);
}

// Doubled values with the same common isovalues must give the same scene.
TEST(Volumes, IsosurfaceCoordinateIsAffine) {
  Scene<3> scene = test::cornell(test::ball<3>(25), {0.6, 0.9}), doubled = scene;
  doubled.volumes[0].field =
      test::sampled<3>(25, [](const Vec3& x) { return 2 * (1 - (x - Vec3(0.5)).length()) + 3; });
  doubled.volumes[0].offset = 3;
  doubled.volumes[0].scale = 2;
  const auto settings = test::fixed_settings<3>(EstimatorName::gather, 16, 200'000);
  const Baked<3> a = test::baked(scene, settings), b = test::baked(doubled, settings);
  ASSERT_EQ(a.grids[0].lattice.active.size(), b.grids[0].lattice.active.size());
  double difference = 0, sum = 0;
  for (std::size_t s = 0; s < a.grids[0].radiance.size(); ++s) {
    difference += std::abs(a.grids[0].radiance[s].y - b.grids[0].radiance[s].y);
    sum += a.grids[0].radiance[s].y;
  }
  EXPECT_LT(difference, 0.02 * sum);
}

TEST(Isosurfaces, EmitTheirOwnLight) {
  Scene<3> scene = test::cornell(test::torus(41), {0.8, 0.92});
  scene.lights.clear();
  scene.volumes[0].emission = ColorRamp({{0.8, Rgb(1, 0.2f, 0.1f)}, {0.92, Rgb(0.1f, 0.2f, 1)}});
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    SCOPED_TRACE(static_cast<int>(estimator));
    test::expect_agreement(scene, 0.85, estimator, 64, 4'000'000, 0.01, 0.05);
  }
}

TEST(Isosurfaces, TakeTheirColorFromTheIsovalue) {
  Scene<3> scene = test::cornell(test::ball<3>(41), {0.6, 0.9});
  scene.volumes[0].albedo = ColorRamp({{0.6, Rgb(0.9f, 0.1f, 0.1f)}, {0.9, Rgb(0.1f, 0.1f, 0.9f)}});
  test::expect_agreement(scene, 0.72, EstimatorName::gather, 64, 500'000, 0.01, 0.06);
}

TEST(Isosurfaces, HaveTwoSides) {
  // The isosurface is a sheet that ends at the domain's border.
  const Scene<3> scene = test::cornell(
      test::sampled<3>(
          33, [](const Vec3& x) { return 1 - x.z + 0.1 * std::sin(9 * x.x) * std::cos(7 * x.y); }),
      {0.2, 0.8});
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    SCOPED_TRACE(static_cast<int>(estimator));
    auto settings = test::fixed_settings<3>(estimator, test::fewer(64), test::fewer(4'000'000));
    settings.both_sides = true;
    const Baked<3> baked = test::baked(scene, settings);
    ASSERT_TRUE(baked.grids[0].has_back());
    for (const bool back : {false, true}) {
      const test::Agreement found = side_agreement(scene, baked, 0, back, 0.5);
      if (test::sanitized) continue;
      EXPECT_NEAR(found.mean_ratio, 1, 0.02);
      EXPECT_LT(found.relative_rms, estimator == EstimatorName::path ? 0.25 : 0.13);
    }
  }
}

// Sums of baked and path-traced radiance over some vertices of all walls, for one common isovalue.
struct WallSums {
  double baked = 0, truth = 0, square = 0, count = 0;  // sums; square of the differences
};

WallSums wall_sums(const Scene<3>& scene, const Baked<3>& baked, double c, int paths) {
  const WallRadiance<3>& walls = baked.walls;
  WallSums sums;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    std::vector<FacetPoint> points;
    std::vector<std::size_t> vertices;
    for (std::size_t v = 0; v < walls.meshes[m].fine.places.size(); v += 29) {
      points.push_back(walls.meshes[m].fine.places[v]);
      vertices.push_back(v);
    }
    const auto reference = test::traced(scene, points, c, paths, 1);
    const auto radiance = radiance_at(walls, static_cast<int>(m), c, false);
    for (std::size_t i = 0; i < points.size(); ++i, ++sums.count) {
      const double found = radiance[vertices[i]].y, expected = reference[i].radiance.y;
      sums.baked += found;
      sums.truth += expected;
      sums.square += std::pow(found - expected, 2);
    }
  }
  return sums;
}

TEST(Walls, AreLitPerIsovalue) {
  const Scene<3> scene = test::cornell(test::ball<3>(41), {0.6, 0.9});
  FixedSettings<3> settings;
  settings.walls = true;
  settings.samples = test::fewer(64);
  const Baked<3> baked = test::baked(scene, settings);
  ASSERT_EQ(baked.walls.radiance.size(), scene.meshes.size());
  for (const double c : {0.62, 0.75, 0.88}) {
    const WallSums walls = wall_sums(scene, baked, c, test::fewer(1024));
    if (test::sanitized) continue;
    EXPECT_NEAR(walls.baked / walls.truth, 1, 0.015) << c;
    EXPECT_LT(std::sqrt(walls.square / walls.count) / (walls.truth / walls.count), 0.1) << c;
  }
}

// A glass isosurface has no baked texels, but the floor must show its caustic.
TEST(Walls, ShowTheCausticOfAGlassIsosurface) {
  Scene<3> scene = test::cornell(test::ball<3>(41), {0.75, 0.85});
  scene.volumes[0].scattering = Scattering::glass;
  scene.volumes[0].albedo = Rgb(1);
  FixedSettings<3> settings;
  EXPECT_THROW(test::baked(scene, settings), Error);
  settings.walls = true;
  settings.samples = test::fewer(64);
  settings.photons = test::fewer(2'000'000);
  settings.caustic_photons = test::fewer(8'000'000);
  const WallSums walls = wall_sums(scene, test::baked(scene, settings), 0.8, test::fewer(4096));
  EXPECT_NEAR(walls.baked / walls.truth, 1, test::sanitized ? 0.3 : 0.02);
}

}  // namespace
}  // namespace leaflight
