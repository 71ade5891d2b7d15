// SPDX-License-Identifier: GPL-3.0-or-later
// Tests light transport in two dimensions (thesis ch. 3).
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "base/sampling.h"
#include "fields.h"
#include "statistics.h"
#include "surface/project.h"
#include "transport/reference.h"

namespace leaflight {
namespace {

using Point = Vec<2>;

constexpr double c = 0.72;

Scene<2> disc_scene(const Rgb& isosurface_albedo) {
  return test::scene_of(test::ball<2>(65), isosurface_albedo, {0.55, 0.9});
}

Scene<2> furnace(double albedo) {
  Scene<2> scene = disc_scene(Rgb(1));
  // The corners of a square, counter-clockwise.
  const std::array<Point, 4> corners{{{-0.3, -0.3}, {1.3, -0.3}, {1.3, 1.3}, {-0.3, 1.3}}};
  for (int i = 0; i < 4; ++i) {
    const Point edge = corners[(i + 1) % 4] - corners[i];
    scene.meshes.push_back(test::wall(corners[i], edge, Rgb(static_cast<Real>(albedo))));
    scene.lights.push_back(AreaLight<2>{"glow", corners[i], {edge}, Rgb(1)});
  }
  return scene;
}

std::vector<Point> disc_points(const Field<2>& field, int n) {
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * pi * (i + 0.3) / n;
    const Point p = Point(0.5) + Point(std::cos(angle), std::sin(angle)) * (1 - c);
    points.push_back(project_to_isosurface(field, p, c));
  }
  return points;
}

TEST(Flatland, FurnaceIsExact) {
  for (const double albedo : {0.5, 0.8}) {
    const Scene<2> scene = furnace(albedo);
    const std::vector<Point> points = disc_points(test::field_of(scene), 64);
    EXPECT_NEAR(test::mean_of(test::traced(scene, points, c, 8192, 1)) * (1 - albedo), 1, 0.01);
    for (const EstimatorName estimator : {EstimatorName::gather, EstimatorName::volumetric}) {
      const Baked<2> baked_scene =
          test::baked(scene, test::fixed_settings<2>(estimator, 64, 1'000'000));
      double sum = 0;
      for (const Point& p : points) sum += test::lookup_world(scene, baked_scene, p).x;
      EXPECT_NEAR(sum / static_cast<double>(points.size()) * (1 - albedo), 1, 0.01);
    }
  }
}

// A segment between the angles a and b from the normal gives the irradiance L (sin a - sin b). The
// BRDF in 2D is albedo / 2 (thesis 3.3.7).
TEST(Flatland, DirectLightOfASegmentHasTheClosedForm) {
  Scene<2> scene = test::scene_of(test::sampled<2>(33, [](const Point& x) { return x.y; }),
                                  Rgb(0.8f), {0.2, 0.8});
  scene.lights = {AreaLight<2>{"lamp", {0.2, -0.4}, {Point(0.5, 0)}, Rgb(2)}};
  std::vector<Point> points;
  for (int i = 1; i < 20; ++i) points.emplace_back(i / 20.0, 0.5);
  const auto reference = test::traced(scene, points, 0.5, 2048, 1);
  FixedSettings<2> settings;
  settings.samples = 256;
  const Baked<2> baked_scene = test::baked(scene, settings);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto sine = [&](double x) {
      return (x - points[i].x) / std::hypot(x - points[i].x, 0.9);
    };
    const double expected = 0.8 / 2 * 2 * (sine(0.7) - sine(0.2));
    EXPECT_NEAR(reference[i].radiance.x, expected,
                test::z_limit(points.size()) * reference[i].standard_error.x + 1e-5);
    EXPECT_NEAR(test::lookup_world(scene, baked_scene, points[i]).x, expected, 0.02 * expected);
  }
}

TEST(Flatland, EstimatorsAgreeWithThePathTracer) {
  const Scene<2> scene = test::flat_cornell();
  const std::vector<Point> points = disc_points(test::field_of(scene), 200);
  const auto reference = test::traced(scene, points, c, 4096, 3);
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    const test::Agreement found =
        test::agreement(scene, points, reference, estimator, 256, 1'000'000);
    EXPECT_NEAR(found.mean_ratio, 1, test::sanitized ? 0.1 : 0.01);
    EXPECT_LT(found.relative_rms, test::sanitized ? 1 : 0.05);
  }
}

}  // namespace
}  // namespace leaflight
