// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes with fixed samples, and the passes that their estimators need.
#include "thesis/fixed_samples.h"

#include <gtest/gtest.h>

#include "cancelling.h"
#include "errors.h"
#include "whole_passes.h"

namespace leaflight {
namespace {

using test::same_bits;

FixedSettings<3> quick() { return test::fixed_settings<3>(EstimatorName::gather, 4, 50'000); }

Scene<3> small_scene() { return test::cornell(test::ball<3>(25), {0.6, 0.9}); }

bool same_bits(const Baked<3>& a, const Baked<3>& b) { return same_bits(a.grids[0], b.grids[0]); }

TEST(FixedSamples, AreTheSameForAnyNumberOfThreads) {
  const Scene<3> scene = small_scene();
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    FixedSettings<3> settings = quick();
    settings.estimator = estimator;
    std::vector<Baked<3>> bakes;
    for (const int threads : {1, 2, 5}) {
      settings.threads = threads;
      bakes.push_back(test::baked(scene, settings));
      EXPECT_EQ(bakes.back().statistics.rays, bakes.front().statistics.rays);
    }
    EXPECT_TRUE(same_bits(bakes[0], bakes[1]));
    EXPECT_TRUE(same_bits(bakes[0], bakes[2]));
  }
}

TEST(FixedSamples, DependOnTheSeed) {
  const Scene<3> scene = small_scene();
  FixedSettings<3> settings = quick();
  const Baked<3> before = test::baked(scene, settings);
  settings.seed = 1;
  EXPECT_FALSE(same_bits(before, test::baked(scene, settings)));
}

double seconds_to_cancel_a_bake(EstimatorName estimator) {
  const Scene<3> scene = test::cornell(test::ball<3>(65), {0.3, 0.9});
  FixedSettings<3> settings = quick();
  settings.samples = 4096;  // takes about ten minutes
  settings.estimator = estimator;
  return test::seconds_to_cancel(
      [&](Progress& progress) { bake_with_fixed_samples(scene, settings, progress); });
}

TEST(FixedSamples, AreCancelled) {
  seconds_to_cancel_a_bake(EstimatorName::gather);
  seconds_to_cancel_a_bake(EstimatorName::path);
}

TEST(FixedSamples, AreCancelledWithinHalfASecond) {
  EXPECT_LT(seconds_to_cancel_a_bake(EstimatorName::gather), 0.5);
  EXPECT_LT(seconds_to_cancel_a_bake(EstimatorName::path), 0.5);
}

Plan plan_for(const Scene<3>& scene, EstimatorName estimator) {
  FixedSettings<3> settings;
  settings.estimator = estimator;
  return make_plan(scene, settings);
}

TEST(Plan, SaysWhatItSkipsAndWhy) {
  Scene<3> scene = small_scene();
  const Plan all = plan_for(scene, EstimatorName::gather);
  std::vector<std::string> skipped;
  for (const SkippedPass& pass : all.skipped) skipped.push_back(pass.pass);
  const std::vector<std::string> expected{"specular light", "caustics", "radiance of the walls",
                                          "back", "radiance of the back"};
  EXPECT_EQ(skipped, expected);
  EXPECT_FALSE(all.back_side);

  const Plan path = plan_for(scene, EstimatorName::path);
  EXPECT_FALSE(path.photons);
  EXPECT_TRUE(path.indirect);

  scene.meshes.clear();
  EXPECT_FALSE(plan_for(scene, EstimatorName::gather).wall_cache);
  EXPECT_TRUE(plan_for(scene, EstimatorName::gather).photons);

  scene.volumes[0].albedo = Rgb(0);
  const Plan black = plan_for(scene, EstimatorName::gather);
  EXPECT_FALSE(black.indirect);
  EXPECT_FALSE(black.photons);
  EXPECT_EQ(black.skipped.size(), 8u);
}

TEST(Plan, BackIsNeededWhereAnIsosurfaceIsOpen) {
  Scene<3> open = small_scene();
  open.isovalue_range = {0.1, 0.9};  // the lowest isosurfaces reach the border of the domain
  EXPECT_TRUE(plan_for(open, EstimatorName::gather).back_side);
  Scene<3> lit_inside = small_scene();
  lit_inside.lights.push_back(
      AreaLight<3>{"back lamp", {0.5, 0.5, 0.5}, {Vec3(0.1, 0, 0), Vec3(0, 0.1, 0)}, Rgb(1)});
  EXPECT_TRUE(plan_for(lit_inside, EstimatorName::gather).back_side);
}

// Part of an edge of the lamp's box is inside a tilted domain, although the lowest and highest
// corners of the box are outside it.
TEST(Plan, BackIsNeededWhereALampReachesIn) {
  Scene<3> scene = small_scene();
  Affine<3> askew;
  const double s = std::sqrt(0.5) / 24;
  askew.column = {Vec3(s, s, 0), Vec3(-s, s, 0), Vec3(0, 0, 1.0 / 24)};
  Field<3>& domain = scene.volumes[0].field;
  domain = make_field(domain.values, domain.dims, askew, domain.owner);
  for (const double y : {0.0, -1.5}) {
    scene.lights = {PointLight<3>{"lamp", {0.5, y, 0.5}, 0.5, Rgb(1), {}}};
    EXPECT_EQ(plan_for(scene, EstimatorName::gather).back_side, y == 0) << y;
  }
}

TEST(Plan, ForcingASkippedPassChangesNothing) {
  const Scene<3> scene = small_scene();
  Plan forced = plan_for(scene, EstimatorName::gather);
  forced.back_side = true;
  Progress progress;
  EXPECT_TRUE(same_bits(test::baked(scene, quick()),
                        bake_with_fixed_samples(scene, quick(), forced, progress)));
}

TEST(FixedSamples, RefuseBadSettings) {
  using Settings = FixedSettings<3>;
  const std::pair<const char*, std::function<void(Settings&)>> cases[] = {
      {"samples", [](Settings& s) { s.samples = 0; }},
      {"photons", [](Settings& s) { s.photons = 0; }},
      {"threads", [](Settings& s) { s.threads = -1; }},
      {"gathers 1 photons", [](Settings& s) { s.photon_map.k = 1; }},
      {"needs all texels", [](Settings& s) { s.only_at = {Vec3(0.5)}; }},
  };
  for (const auto& [words, change] : cases) {
    Settings settings = quick();
    change(settings);
    test::expect_refused(words, [&] { test::baked(small_scene(), settings); });
  }
}

}  // namespace
}  // namespace leaflight
