// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes in passes of lines.
#include "bake/driver/passes.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/sampling.h"
#include "cancelling.h"
#include "whole_passes.h"

namespace leaflight {
namespace {

using test::all_light;
using test::expect_same_light;
using test::in_passes;
using test::previous_light;
using test::same_bits;
using test::small_scene;
using test::stopped_after;
using test::with_all_light;

TEST(Passes, AreTheSameForAnyNumberOfThreads) {
  const Scene<3> scene = test::cornell(test::torus(17), {0.6, 0.95});
  BakeSettings<3> settings = all_light(17);
  std::vector<Baked<3>> bakes;
  for (const int threads : {1, 5}) {
    settings.threads = threads;
    bakes.push_back(test::baked(scene, settings));
  }
  expect_same_light(bakes);
}

TEST(Passes, StoppedAfterTheSamePassAreTheSame) {
  const Scene<3> scene = small_scene();
  BakeSettings<3> settings = in_passes();
  settings.resolution = {9, 9, 9};
  settings.error = 0.02;  // takes several passes
  std::vector<RadianceGrid<3>> passes;
  Progress first_progress;
  const auto look = [&](Baked<3>&& baked) {
    EXPECT_EQ(baked.statistics.passes, static_cast<int>(passes.size()) + 1);
    passes.push_back(std::move(baked.grids[0]));
  };
  const Baked<3> all = bake<3>(scene, settings, first_progress, {look});
  passes.push_back(all.grids[0]);
  EXPECT_FALSE(all.statistics.stopped);
  ASSERT_GE(passes.size(), 2u);
  Progress progress;
  const Baked<3> stopped =
      bake<3>(scene, settings, progress, {[&](Baked<3>&&) { progress.stop(); }});
  EXPECT_TRUE(stopped.statistics.stopped);
  EXPECT_EQ(stopped.statistics.passes, 1);
  EXPECT_TRUE(same_bits(passes[0], stopped.grids[0]));
  // A bake without a callback.
  EXPECT_TRUE(same_bits(all.grids[0], test::baked(scene, settings).grids[0]));
}

TEST(Passes, ContinuedAreTheSameForAnyNumberOfThreads) {
  const Scene<3> scene = test::cornell(test::torus(17), {0.6, 0.95});
  BakeSettings<3> settings = all_light(17);
  std::vector<Baked<3>> bakes;
  for (const int threads : {1, 2, 5}) {
    settings.threads = threads;
    const std::vector<PreviousLight<3>> previous =
        previous_light(stopped_after(1, scene, settings));
    bakes.push_back(test::baked<3>(scene, settings, {{}, &previous}));
    EXPECT_EQ(bakes.back().statistics.passes, 2);
  }
  expect_same_light(bakes);
}

// The mean difference of two grids over both sides, relative to the mean of the second, and the
// relative difference of the means.
struct Difference {
  double per_texel = 0, in_mean = 0;

  Difference(const RadianceGrid<3>& a, const RadianceGrid<3>& b) {
    add(a.radiance, b.radiance);
    add(a.radiance_back, b.radiance_back);
    per_texel /= all;
    in_mean /= all;
  }

 private:
  void add(const std::vector<Vec<3, float>>& a, const std::vector<Vec<3, float>>& b) {
    for (std::size_t s = 0; s < a.size(); ++s) {
      per_texel += std::abs(a[s].y - b[s].y);
      in_mean += a[s].y - b[s].y;
      all += b[s].y;
    }
  }
  double all = 0;
};

TEST(Passes, ContinuedErrAsIfTheyHadNeverBeenStopped) {
  if (test::sanitized) GTEST_SKIP() << "statistics are for other builds";
  Scene<3> glowing = test::cornell(test::ball<3>(25), {0.6, 0.9});
  glowing.volumes[0].emission = ColorRamp(Rgb(0.05f, 0.1f, 0));
  const struct {
    const char* name;
    Scene<3> scene;
    int texels;
  } cases[] = {{"torus", test::cornell(test::torus(25), {0.7, 0.95}), 25},
               {"glowing ball", glowing, 25},
               {"texels of another width", glowing, 31}};
  for (const auto& [name, scene, texels] : cases) {
    BakeSettings<3> settings = in_passes(0.05);
    settings.both_sides = true;
    settings.resolution = Index<3>{texels, texels, texels};
    settings.seed = 9;
    const Baked<3> truth = with_all_light(scene, stopped_after(5, scene, settings));
    // A single bake may be closer by chance.
    constexpr int seeds = 4;
    double now = 0, then = 0, means = 0, noise = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      settings.seed = seed;
      const Baked<3> uninterrupted = with_all_light(scene, stopped_after(2, scene, settings));
      const Baked<3> continued = with_all_light(
          scene, test::continued(stopped_after(1, scene, settings), scene, settings));
      const Difference one(continued.grids[0], truth.grids[0]);
      const Difference other(uninterrupted.grids[0], truth.grids[0]);
      now += one.per_texel / seeds;
      then += other.per_texel / seeds;
      means += (one.in_mean - other.in_mean) / seeds;
      noise += continued.statistics.noise_percent / uninterrupted.statistics.noise_percent / seeds;
    }
    EXPECT_LT(now, 1.1 * then) << name;
    EXPECT_NEAR(means, 0, 0.01) << name;
    EXPECT_NEAR(noise, 1, 0.25) << name;
  }
}

TEST(Passes, ContinuedLookPreviousLightUp) {
  Scene<3> glowing = small_scene();
  glowing.volumes[0].emission = ColorRamp(Rgb(0.05f, 0.1f, 0));
  BakeSettings<3> settings = in_passes(0.05);
  settings.both_sides = true;
  settings.resolution = {17, 17, 17};
  const Baked<3> uninterrupted = with_all_light(glowing, stopped_after(2, glowing, settings));
  const Baked<3> continued = with_all_light(
      glowing, test::continued(stopped_after(1, glowing, settings), glowing, settings));
  // Inside the ball, most light is reflected more than once.
  EXPECT_NEAR(Difference(continued.grids[0], uninterrupted.grids[0]).in_mean, 0,
              test::sanitized ? 0.05 : 0.02);
}

Baked<3> whole_bake(const Scene<3>& scene, const BakeSettings<3>& settings) {
  return with_all_light(scene, test::baked(scene, settings));
}

// Compares the errors that continued bakes report with their differences from the mean of other
// bakes.
TEST(Passes, ContinuedKnowTheirError) {
  if (test::sanitized) GTEST_SKIP() << "statistics are for other builds";
  const Scene<3> scene = test::cornell(test::torus(25), {0.7, 0.95});
  BakeSettings<3> settings = in_passes(0.1);
  settings.resolution = {25, 25, 25};
  constexpr int bakes = 8;
  std::vector<Vec<3, float>> sum_of_others;
  std::vector<float> variance;  // variance of the sum
  for (int i = 0; i < bakes; ++i) {
    settings.seed = 9 + i;
    const RadianceGrid<3> other = whole_bake(scene, settings).grids[0];
    sum_of_others.resize(other.radiance.size(), Vec<3, float>(0));
    variance.resize(other.radiance.size());
    for (std::size_t s = 0; s < variance.size(); ++s) {
      sum_of_others[s] += other.radiance[s];
      variance[s] += other.radiance_error[s] * other.radiance_error[s];
    }
  }
  const auto coverage = [&](const Baked<3>& baked) {
    const RadianceGrid<3>& grid = baked.grids[0];
    const auto light = all_light(grid, test::field_of(scene), false);
    std::size_t within = 0;
    for (std::size_t s = 0; s < light.size(); ++s) {
      const Vec<3, float> off = light[s] - sum_of_others[s] / float(bakes);
      const double error = std::hypot(grid.radiance_error[s], std::sqrt(variance[s]) / bakes);
      within += std::abs(off.x + off.y + off.z) / 3 <= 1.96 * error;
    }
    return static_cast<double>(within) / static_cast<double>(light.size());
  };
  double sum = 0;
  constexpr int seeds = 4;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = seed;
    const Baked<3> once = test::continued(stopped_after(1, scene, settings), scene, settings);
    sum += (coverage(once) + coverage(test::continued(once, scene, settings))) / 2;
  }
  EXPECT_NEAR(sum / seeds, 0.95, 0.03);
}

TEST(Passes, GoOnWithTheirOwnTexelsAlone) {
  const Scene<3> scene = small_scene();
  BakeSettings<3> settings = in_passes(5);
  settings.resolution = {17, 17, 17};
  BakeSettings<3> coarse = settings;
  coarse.resolution = {9, 9, 9};
  const std::vector<PreviousLight<3>> other = previous_light(test::baked(scene, coarse));
  // A first picture has other texels, so a bake that continues it starts from the beginning.
  EXPECT_TRUE(same_bits(test::baked(scene, settings).grids[0],
                        test::baked<3>(scene, settings, {{}, &other}).grids[0]));
  const Scene<3> wider = test::cornell(test::ball<3>(17), {0.4, 0.9});
  EXPECT_THROW(test::baked<3>(wider, coarse, {{}, &other}), Error);
}

TEST(Passes, EndInTime) {
  BakeSettings<3> settings = in_passes();
  settings.error = 1e-4;
  settings.seconds = 1e-9;  // is over before the second pass
  const Baked<3> baked = test::baked(small_scene(), settings);
  EXPECT_TRUE(baked.statistics.stopped);
  EXPECT_GT(baked.statistics.noise_percent, 1e-4);
}

TEST(Passes, ExpectTheirWorkAndThatOfTheWalls) {
  BakeSettings<3> settings = test::in_passes(20);
  settings.resolution = {9, 9, 9};
  for (const bool walls : {false, true}) {
    settings.walls = walls;
    Progress progress;
    EXPECT_EQ(progress.fraction(), 0);
    bake(small_scene(), settings, progress);
    EXPECT_FALSE(progress.stage().empty());
    EXPECT_GT(progress.fraction(), 0.5);
    EXPECT_LT(progress.fraction(), 1);
  }
}

double seconds_to_cancel_passes() {
  const Scene<3> scene = test::cornell(test::ball<3>(65), {0.3, 0.9});
  BakeSettings<3> settings = in_passes();
  settings.error = 1e-4;  // is not reached
  return test::seconds_to_cancel([&](Progress& progress) { bake(scene, settings, progress); });
}

TEST(Passes, AreCancelled) { seconds_to_cancel_passes(); }

TEST(Passes, AreCancelledWithinHalfASecond) {
  EXPECT_LT(seconds_to_cancel_passes(), test::sanitized ? 5 : 0.5);
}

// Calls check(position, value) for the center of each texel.
template <class Check>
void for_each_center(const Scene<3>& scene, const Baked<3>& baked, Check check) {
  const RadianceGrid<3>& grid = baked.grids[0];
  const Field<3>& field = test::field_of(scene);
  std::size_t checked = 0;
  for (std::size_t s = 0; s < grid.lattice.active.size(); ++s) {
    const Vec3 center = grid.lattice.center(grid.lattice.active[s]);
    const CellPoint<3> at = locate(field, center);
    const double c = interpolate(load_corners(field, at.cell), at.local);
    if (!scene.isovalue_range.contains(c)) continue;
    check(field.index_to_world.point(center), c, s);
    ++checked;
  }
  EXPECT_GT(checked, 100u);
}

TEST(Passes, PlanesInTheSunAreExact) {
  // h decreases with z, so isosurfaces are planes that face up.
  Scene<3> scene = test::scene_of(test::sampled<3>(9, [](const Vec3& x) { return 1 - x.z; }),
                                  Rgb(0.5f), {0.2, 0.8});
  const Vec3 down = Vec3(0.3, -0.2, -1).normalized();
  scene.lights.push_back(SunLight<3>{"sun", down, Rgb(2, 1, 0.5f)});
  const Baked<3> baked = whole_bake(scene, in_passes());
  for_each_center(scene, baked, [&](const Vec3&, double, std::size_t s) {
    const double factor = 0.5 / pi * -down.z;
    const auto& radiance = baked.grids[0].radiance[s];
    EXPECT_NEAR(radiance.x, 2 * factor, 1e-5);
    EXPECT_NEAR(radiance.z, 0.5 * factor, 1e-5);
    EXPECT_LT(baked.grids[0].radiance_error[s], 1e-4);
  });
}

TEST(Passes, PlanesUnderAPointLightFollowItsLaw) {
  Scene<3> scene = test::scene_of(test::sampled<3>(17, [](const Vec3& x) { return 1 - x.z; }),
                                  Rgb(0.8f), {0.2, 0.8});
  const Vec3 lamp(0.4, 0.7, 1.5);
  scene.lights.push_back(PointLight<3>{"bulb", lamp, 0, Rgb(3.0f), {}});
  BakeSettings<3> settings = in_passes();
  settings.resolution = {65, 65, 65};  // is the default, but not with sanitizers
  const Baked<3> baked = whole_bake(scene, settings);
  for_each_center(scene, baked, [&](const Vec3& x, double, std::size_t s) {
    const Vec3 to_lamp = lamp - x;
    const double expected = 0.8 / pi * 3 * to_lamp.z / std::pow(to_lamp.length(), 3);
    // The tolerance covers the width of a texel.
    EXPECT_NEAR(baked.grids[0].radiance[s].x, expected, 0.02 * expected);
  });
}

TEST(Passes, ALightWithinTheVolumeShinesToAllSides) {
  // Isosurfaces are spheres of radius 0.4 to 0.1 about the light.
  Scene<3> scene = test::scene_of(test::ball<3>(test::sanitized ? 17 : 49), Rgb(0.5f), {0.6, 0.9});
  scene.lights.push_back(PointLight<3>{"bulb", Vec3(0.5), 0, Rgb(1.0f), {}});
  BakeSettings<3> settings = in_passes();
  settings.both_sides = true;
  const Baked<3> baked = whole_bake(scene, settings);
  ASSERT_TRUE(baked.grids[0].has_back());
  double ratio = 0;
  int count = 0;
  for_each_center(scene, baked, [&](const Vec3& x, double c, std::size_t s) {
    if (c > 0.8) return;  // texels are too wide for such a small sphere
    // The inside receives I / r^2. A sphere also lights itself equally everywhere, so that it
    // reflects a / (1 - a) I / (pi r^2). The albedo a is a half.
    const double expected = 1 / (pi * (x - Vec3(0.5)).length2());
    EXPECT_LT(baked.grids[0].radiance[s].x, 0.02 * expected);
    ratio += baked.grids[0].radiance_back[s].x / expected;
    ++count;
  });
  if (test::sanitized) return;
  // Lines look up indirect light half a texel closer to the light than the isosurface that they
  // hit.
  EXPECT_NEAR(ratio / count, 1, 0.08);
}

TEST(Passes, FurnaceIsUniform) {
  if (test::sanitized) GTEST_SKIP() << "statistics are for other builds";
  const Scene<3> scene = test::furnace(test::torus(17), {0.7, 0.95}, 1, 0.5f);
  BakeSettings<3> settings = in_passes();
  settings.exposure = 0.2;  // so that no color is white, whose noise would be ignored
  const Baked<3> baked = whole_bake(scene, settings);
  double sum = 0, square = 0;
  int count = 0;
  for_each_center(scene, baked, [&](const Vec3&, double, std::size_t s) {
    const double off = baked.grids[0].radiance[s].y / 2 - 1;  // emission / (1 - albedo) = 2
    sum += off;
    square += off * off;
    ++count;
  });
  EXPECT_NEAR(sum / count, 0, 0.02);
  EXPECT_LT(std::sqrt(square / count), 0.15);
}

TEST(Passes, AgreeWithThePathTracer) {
  if (test::sanitized) GTEST_SKIP() << "statistics are for other builds";
  const struct {
    const char* name;
    Scene<3> scene;
    double c;
  } cases[] = {{"ball", test::cornell(test::ball<3>(25), {0.6, 0.9}), 0.7},
               {"torus", test::cornell(test::torus(33), {0.75, 0.95}), 0.85}};
  for (const auto& [name, scene, c] : cases) {
    const std::vector<Vec3> points = test::isosurface_points(test::field_of(scene), c, 40);
    const auto truth = test::traced(scene, points, c, 2048, 5);
    const Baked<3> baked = test::baked(scene, in_passes());
    const test::Agreement agreement = test::compare(points.size(), truth, [&](std::size_t i) {
      return test::lookup_world(scene, baked, points[i]);
    });
    EXPECT_NEAR(agreement.mean_ratio, 1, 0.01) << name;
    EXPECT_LT(agreement.relative_rms, 0.035) << name;
  }
}

}  // namespace
}  // namespace leaflight
