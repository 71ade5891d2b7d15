// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "base/sampling.h"
#include "scenes.h"
#include "statistics.h"
#include "surface/marching_cubes.h"
#include "surface/project.h"
#include "transport/reference.h"

namespace leaflight {
namespace {

constexpr double c = 0.72;

class Furnace : public testing::TestWithParam<double> {};

// In a closed box, radiance is E / (1 - albedo) everywhere (furnace test).
TEST_P(Furnace, PathTracerIsExact) {
  const double albedo = GetParam();
  const Scene<3> scene =
      test::furnace(test::ball<3>(33), {0.55, 0.9}, 1, static_cast<Real>(albedo));
  const auto reference =
      test::traced(scene, test::isosurface_points(test::field_of(scene), c, 40), c, 8192, 1);
  ASSERT_GT(reference.size(), 50u);
  EXPECT_NEAR(test::mean_of(reference) * (1 - albedo), 1, 0.01);
  for (const auto& r : reference) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(r.radiance[k], 1 / (1 - albedo),
                  test::z_limit(3 * reference.size()) * r.standard_error[k] + 0.005 / (1 - albedo));
    }
  }
}

TEST_P(Furnace, BakesAreExact) {
  const double albedo = GetParam();
  const Scene<3> scene =
      test::furnace(test::ball<3>(33), {0.55, 0.9}, 1, static_cast<Real>(albedo));
  for (const EstimatorName estimator : {EstimatorName::gather, EstimatorName::volumetric}) {
    const Baked<3> baked_scene =
        test::baked(scene, test::fixed_settings<3>(estimator, 64, 1'000'000));
    double sum = 0;
    const std::vector<Vec3> points = test::isosurface_points(test::field_of(scene), c, 7);
    for (const Vec3& p : points) sum += test::lookup_world(scene, baked_scene, p).x;
    EXPECT_NEAR(sum / static_cast<double>(points.size()) * (1 - albedo), 1, 0.01)
        << (estimator == EstimatorName::gather ? "gather" : "volumetric");
  }
}

INSTANTIATE_TEST_SUITE_P(Albedos, Furnace, testing::Values(0.5, 0.8));

// Returns the irradiance at p, with normal n, from a polygon of radiance 1 that is entirely above
// the horizon (Lambert).
double lambert_irradiance(const Vec3& p, const Vec3& n, const std::vector<Vec3>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = (polygon[i] - p).normalized();
    const Vec3 b = (polygon[(i + 1) % polygon.size()] - p).normalized();
    sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(n);
  }
  return std::abs(sum) / 2;
}

TEST(DirectLight, RectangleOverPlaneHasTheClosedForm) {
  // h = z: the isosurfaces are planes whose outside faces -z, towards a lamp below.
  Scene<3> scene = test::scene_of(test::sampled<3>(25, [](const Vec3& x) { return x.z; }),
                                  Rgb(0.8f), {0.2, 0.8});
  const AreaLight<3> lamp{
      "lamp", {0.1, 0.3, -0.4}, {Vec3(0.5, 0, 0), Vec3(0, 0.3, 0)}, Rgb(2, 1, 4)};
  scene.lights = {lamp};
  FixedSettings<3> settings;
  settings.samples = 256;
  const Baked<3> baked_scene = test::baked(scene, settings);
  const std::vector<Vec3> polygon{lamp.point({0, 0}), lamp.point({1, 0}), lamp.point({1, 1}),
                                  lamp.point({0, 1})};
  Random random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) {
    points.emplace_back(0.1 + 0.8 * random.uniform(), 0.1 + 0.8 * random.uniform(), 0.5);
  }
  const auto reference = test::traced(scene, points, 0.5, 1024, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = 0.8 / pi * lambert_irradiance(points[i], {0, 0, -1}, polygon);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(reference[i].radiance[k], expected * lamp.radiance[k],
                  test::z_limit(3 * points.size()) * reference[i].standard_error[k] + 1e-5);
    }
    // A texel is the mean over a small box, so it deviates slightly from the closed form.
    const auto baked = test::lookup_world(scene, baked_scene, points[i]);
    EXPECT_NEAR(baked.x, expected * 2, 0.02 * expected * 2);
  }
}

TEST(Estimators, AgreeWithThePathTracer) {
  const Scene<3> scene = test::cornell(test::ball<3>(41), {0.6, 0.9});
  test::expect_agreement(scene, c, EstimatorName::gather, 64, 500'000, 0.01, 0.06);
  test::expect_agreement(scene, c, EstimatorName::path, 64, 1, 0.01, 0.08);
}

TEST(Estimators, PhotonDensityAgreesWithThePathTracer) {
  const Scene<3> scene = test::cornell(test::ball<3>(41), {0.6, 0.9});
  test::expect_agreement(scene, c, EstimatorName::volumetric, 64, 4'000'000, 0.01, 0.06);
}

// The isosurface is a sheet that ends at the domain's border. Light reaches its back and returns
// through the box.
TEST(Estimators, AgreeOnAnOpenIsosurface) {
  const Scene<3> scene = test::cornell(
      test::sampled<3>(
          33, [](const Vec3& x) { return 1 - x.z + 0.1 * std::sin(9 * x.x) * std::cos(7 * x.y); }),
      {0.2, 0.8});
  test::expect_agreement(scene, 0.5, EstimatorName::gather, 64, 1'000'000, 0.015, 0.08);
}

}  // namespace
}  // namespace leaflight
