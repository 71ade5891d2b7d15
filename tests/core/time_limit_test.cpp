// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes with a time limit. Their clock counts work, so results do not depend on the machine.
#include "bake/driver/time_limit.h"

#include <gtest/gtest.h>

#include <sstream>

#include "whole_passes.h"

namespace leaflight {
namespace {

using test::same_bits;

TEST(TimeLimit, IsOverWhereWhatIsToComeEndsTooLate) {
  double now = 5;
  const auto clock = [&] { return now; };
  const TimeLimit limit(10, clock), none(0, clock);
  now = 12;
  EXPECT_EQ(limit.seconds(), 7);
  EXPECT_FALSE(limit.is_over(3));
  EXPECT_TRUE(limit.is_over(3.1));
  EXPECT_FALSE(none.is_given());
  EXPECT_FALSE(none.is_over(1e9));
}

constexpr int voxels = 33, wider = 17, preview = 9;

Scene<3> scene() {
  Scene<3> scene = test::cornell(test::ball<3>(voxels), {0.4, 0.9});
  scene.meshes.resize(1);
  return scene;
}

// A bake with a time limit, whose seconds are units of work.
struct Limited {
  BakeSettings<3> settings = test::in_passes(1e-3);  // is not reached
  Progress progress;
  Checkpoints checkpoints;
  const Workers* workers = nullptr;
  double lost = 0;  // seconds lost to other programs

  explicit Limited(double limit) {
    settings.resolution = {voxels, voxels, voxels};
    settings.seconds = limit;
    checkpoints.seconds = 0;
  }
  std::function<void(const Checkpoints::Write&)> time_is_left_once_texels_are_chosen() {
    return [this](const Checkpoints::Write&) { lost = -1e3 * settings.seconds; };
  }
  Baked<3> bake() {
    BakeHooks<3> hooks;
    hooks.checkpoints = &checkpoints;
    hooks.workers = workers;
    hooks.clock = [this] { return progress.work() + lost; };
    return leaflight::bake<3>(scene(), settings, progress, hooks);
  }
};

int texels_along(const Baked<3>& baked) { return baked.grids[0].lattice.resolution[0]; }

// Returns the work of a bake that is stopped after its first pass.
double work_of_a_pass() {
  Limited unlimited(0);
  BakeHooks<3> hooks;
  hooks.on_pass = [&](Baked<3>&&) { unlimited.progress.stop(); };
  bake<3>(scene(), unlimited.settings, unlimited.progress, hooks);
  return unlimited.progress.work();
}

bool says(const Baked<3>& baked, const char* what) {
  const std::vector<SkippedPass>& skipped = baked.statistics.skipped;
  return std::any_of(skipped.begin(), skipped.end(),
                     [&](const SkippedPass& one) { return one.pass == what; });
}

TEST(TimeLimit, IsKeptByWiderTexels) {
  const double pass = work_of_a_pass();
  for (const double passes : {0.15, 0.6, 1.1}) {
    Limited limited(passes * pass);
    const Baked<3> baked = limited.bake();
    const int along = texels_along(baked);
    if (passes < 0.5) {
      EXPECT_EQ(along, preview);
    } else if (passes > 1) {
      EXPECT_EQ(along, voxels);
    }
    EXPECT_LE(limited.progress.work(), 1.1 * passes * pass);
    EXPECT_EQ(says(baked, "finer texels"), along < voxels);
    EXPECT_EQ(baked.statistics.stopped, along < voxels);
    EXPECT_GE(baked.statistics.passes, 1);
  }
}

TEST(TimeLimit, LightsWallsAsFinelyAsItHasRoomFor) {
  Limited unlimited(0);
  unlimited.settings.walls = true;
  unlimited.settings.error = 100;
  const Baked<3> whole = unlimited.bake();
  const double work = unlimited.progress.work();
  for (const auto& [works, finely] : {std::pair(0.5, false), {4.0, true}}) {
    Limited limited(works * work);
    limited.settings.walls = true;
    const Baked<3> baked = limited.bake();
    EXPECT_LE(limited.progress.work(), 1.1 * works * work);
    EXPECT_EQ(says(baked, "finer walls"), !finely);
    const auto exact = whole.walls.direct->radiance(0, 0.7, false),
               found = baked.walls.direct->radiance(0, 0.7, false);
    EXPECT_EQ(same_bits(exact, found), finely);
    double sum = 0, all = 0;
    for (std::size_t v = 0; v < exact.size(); ++v) sum += found[v].x, all += exact[v].x;
    EXPECT_NEAR(sum, all, 0.02 * all);
  }
}

TEST(TimeLimit, IsKeptWhereABakeBecomesSlow) {
  const double limit = 2 * work_of_a_pass();
  Limited limited(limit);
  // Lose the time before the first block.
  limited.checkpoints.save = [&](const Checkpoints::Write&) { limited.lost = 0.75 * limit; };
  const Baked<3> baked = limited.bake();
  EXPECT_EQ(texels_along(baked), preview);
  EXPECT_LE(limited.progress.work() + limited.lost, 1.1 * limit);
  EXPECT_TRUE(baked.statistics.stopped);
}

TEST(TimeLimit, SharesNoLinesWhereTexelsAreWider) {
  const double pass = work_of_a_pass();
  for (const auto& [passes, along] : {std::pair(0.3, wider), {1.1, voxels}}) {
    Limited limited(passes * pass);
    bool shares_lines = false;
    Workers workers;
    workers.send = [](PartData, const Workers::Write&) {};
    workers.announce = [&](const std::vector<BakePart>& parts) {
      for (const BakePart& part : parts) shares_lines |= part.kind == PartKind::block;
      return 0;
    };
    // The bake then computes the parts itself.
    workers.take = [](int) { return std::string(); };
    limited.workers = &workers;
    limited.checkpoints.save = limited.time_is_left_once_texels_are_chosen();
    EXPECT_EQ(texels_along(limited.bake()), along);
    EXPECT_EQ(shares_lines, along == voxels);
  }
}

TEST(TimeLimit, GoesOnFromACheckpointWithTheSameTexels) {
  const double pass = work_of_a_pass();
  for (const auto& [passes, along] : {std::pair(0.15, preview), {0.3, wider}}) {
    Limited first(passes * pass);
    std::string state;
    const auto time_is_left = first.time_is_left_once_texels_are_chosen();
    first.checkpoints.save = [&](const Checkpoints::Write& write) {
      std::ostringstream stream;
      write(stream);
      if (state.empty()) state = stream.str();
      time_is_left(write);
    };
    const Baked<3> whole = first.bake();
    ASSERT_FALSE(state.empty());
    EXPECT_EQ(texels_along(whole), along);
    std::istringstream stream(state);
    Limited second(0);
    second.checkpoints.restore = [&](const Checkpoints::Read& read) { read(stream); };
    const Baked<3> resumed = second.bake();
    EXPECT_TRUE(same_bits(whole.grids[0], resumed.grids[0]));
    EXPECT_EQ(whole.statistics.blocks, resumed.statistics.blocks);
    EXPECT_EQ(whole.statistics.passes, resumed.statistics.passes);
  }
}

}  // namespace
}  // namespace leaflight
