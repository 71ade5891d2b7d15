// SPDX-License-Identifier: GPL-3.0-or-later
// Tests passes that go on with finer texels.
#include <gtest/gtest.h>

#include "whole_passes.h"

namespace leaflight {
namespace {

constexpr int voxels = 41;

// Returns waves that are four voxels long. A texel as wide as a voxel mixes very different light.
Scene<3> wavy_scene() {
  const auto wave = [](double x) { return std::sin(0.5 * M_PI * (voxels - 1) * x + 0.3); };
  const Field<3> field =
      test::sampled<3>(voxels, [&](const Vec3& x) { return wave(x.x) + wave(x.y) + wave(x.z); });
  return test::cornell(field, {-1, 2});
}

struct Passes {
  std::vector<Index<3>> resolutions;  // of indirect light
  std::vector<double> errors;
  Baked<3> last;
};

Passes passes_to(double error, int stop_after = 0) {
  BakeSettings<3> settings;
  settings.error = error;
  Passes passes;
  Progress progress;
  const auto add = [&](const Baked<3>& baked) {
    passes.resolutions.push_back(baked.grids[0].unfiltered.lattice.resolution);
    passes.errors.push_back(baked.statistics.error_percent);
  };
  const auto look = [&](Baked<3>&& baked) {
    add(baked);
    if (static_cast<int>(passes.errors.size()) == stop_after) progress.stop();
  };
  passes.last = bake<3>(wavy_scene(), settings, progress, {look});
  add(passes.last);
  return passes;
}

TEST(FineTexels, LowerAnErrorThatBlocksCannotLower) {
  if (test::sanitized) GTEST_SKIP() << "takes minutes";
  const Passes passes = passes_to(1.5);
  const Index<3> usual{voxels, voxels, voxels}, fine = finer_resolution<3>(usual);
  // The first picture has coarse texels.
  ASSERT_GE(passes.errors.size(), 3u);
  EXPECT_EQ(passes.resolutions[1], usual);
  EXPECT_EQ(passes.resolutions.back(), fine);
  EXPECT_LT(passes.errors.back(), 0.9 * passes.errors[1]);
  EXPECT_FALSE(passes.last.statistics.stopped);
  // A bake with fine texels is continued with them.
  const std::vector<PreviousLight<3>> previous = test::previous_light(passes.last);
  BakeSettings<3> settings;
  settings.error = 0.98 * passes.errors.back();
  const Baked<3> more = test::baked<3>(wavy_scene(), settings, {{}, &previous});
  EXPECT_EQ(more.grids[0].unfiltered.lattice.resolution, fine);
  EXPECT_GT(more.statistics.blocks, passes.last.statistics.blocks);
}

TEST(FineTexels, LeaveTheUsualOnesToABakeThatIsStopped) {
  if (test::sanitized) GTEST_SKIP() << "takes minutes";
  const Passes passes = passes_to(1.5, 2);
  EXPECT_TRUE(passes.last.statistics.stopped);
  ASSERT_EQ(passes.resolutions.size(), 3u);
  EXPECT_EQ(passes.resolutions[2], passes.resolutions[1]);
  EXPECT_EQ(passes.errors[2], passes.errors[1]);
}

}  // namespace
}  // namespace leaflight
