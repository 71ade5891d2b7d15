// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/pass_schedule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leaflight {
namespace {

TEST(PassSchedule, NextBlocksLeaveTheNoiseToReach) {
  // The variance is inversely proportional to the number of blocks.
  for (const int now : {4, 7, 16}) {
    for (const double more : {1.3, 1.6, 1.9}) {
      const int next = next_blocks(now, 1, 1 / more);
      EXPECT_GE(next, more * now);
      EXPECT_LT(next, std::max(more, 1.25) * now + 1);
    }
  }
}

TEST(PassSchedule, NextBlocksAreNeverFewerAndAtMostTwiceAsManyOrEight) {
  EXPECT_EQ(next_blocks(8, 1, 2), 8);
  EXPECT_EQ(next_blocks(2, 1, 0.001), 8);
  EXPECT_EQ(next_blocks(6, 1, 0.001), 12);
  EXPECT_EQ(next_blocks(20, 1, 0.001), 32);
  EXPECT_EQ(next_blocks(50, 1, 0.001), 50);
  EXPECT_EQ(next_blocks(8, INFINITY, 0.001), 16);
}

TEST(PassSchedule, BlocksAreNoneWithoutIndirectLight) { EXPECT_EQ(next_blocks(0, 0, 0), 0); }

TEST(PassSchedule, NoiseIsLeftByTheTextureErrorWithinBounds) {
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 0.8), 0.6);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 0), 0.8);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 1), 0.5);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 4), 2);
  EXPECT_FALSE(is_out_of_reach(1, 0.9));
  EXPECT_TRUE(is_out_of_reach(1, 0.95));
}

TEST(PassSchedule, PredictsAFirstPassFromItsPreview) {
  // Measured for Colin27 and for a bump box of 24^3.
  EXPECT_NEAR(first_pass_seconds({0.35, 0.18, 1.4}, 57), 15.9, 1.6);
  EXPECT_NEAR(first_pass_seconds({0.09, 0.12, 0.056}, 302), 2.1, 0.2);
  // Photons and points of the error estimate take the same time for any number of texels.
  EXPECT_EQ(first_pass_seconds({1, 2, 0}, 8), first_pass_seconds({1, 2, 0}, 64));
}

// A schedule of a bake of 1000 texels, whose steps take a second or a millisecond per texel. Its
// clock is set by hand.
struct Scheduled {
  double now = 0;
  Progress progress;
  PassSchedule schedule;

  explicit Scheduled(double seconds)
      : schedule(TimeLimit(seconds, [this] { return now; }), 1, progress) {
    schedule.texels = 1000;
    schedule.took.texel = 1e-3;
    schedule.took.walls = schedule.took.block = 1;
  }
  // `noise` and `bias` in percent.
  static EndedPass pass(int blocks, int planned, double noise, double bias) {
    return {blocks, planned, {1e-4 * noise * noise, 1e-4 * bias * bias}};
  }
};

TEST(PassSchedule, EndsAtTheTargetErrorOrOutOfTime) {
  Scheduled one(10);
  EXPECT_EQ(one.schedule.after(one.pass(4, 4, 0.7, 0)), NextStep::end);
  EXPECT_EQ(one.schedule.after(one.pass(4, 4, 0.9, 0)), NextStep::more_blocks);
  EXPECT_EQ(one.schedule.blocks_after(one.pass(4, 4, 0.9, 0)), 6);
  // The bias leaves less noise.
  EXPECT_EQ(one.schedule.after(one.pass(4, 4, 0.7, 0.8)), NextStep::more_blocks);
  // A pass that was cut short.
  EXPECT_EQ(one.schedule.after(one.pass(3, 4, 0.9, 0)), NextStep::end_unfinished);
  EXPECT_EQ(one.schedule.after(one.pass(3, 4, 0.7, 0)), NextStep::end);
  // No bake takes more blocks.
  EXPECT_EQ(one.schedule.after(one.pass(32, 32, 0.9, 0)), NextStep::end);
  // The walls, the result and another block take three seconds.
  one.now = 6.9;
  EXPECT_EQ(one.schedule.after(one.pass(4, 4, 0.9, 0)), NextStep::more_blocks);
  one.now = 7.1;
  EXPECT_EQ(one.schedule.after(one.pass(4, 4, 0.9, 0)), NextStep::end_unfinished);
}

TEST(PassSchedule, RefinesTexelsWhoseErrorBlocksDoNotLower) {
  Scheduled one(10);
  EXPECT_TRUE(one.schedule.wants_finer_texels(one.pass(4, 4, 0.5, 2)));
  EXPECT_FALSE(one.schedule.wants_finer_texels(one.pass(4, 4, 2, 0.5)));
  EXPECT_FALSE(one.schedule.wants_finer_texels(one.pass(3, 4, 0.5, 2)));
  one.now = 9;
  EXPECT_FALSE(one.schedule.wants_finer_texels(one.pass(4, 4, 0.5, 2)));
}

TEST(PassSchedule, GoesOnUntilAnotherBlockWouldBeLate) {
  Scheduled one(10);
  one.schedule.begin_block();
  one.now = 4;
  one.schedule.end_block();
  EXPECT_EQ(one.schedule.took.block, 4);
  EXPECT_TRUE(one.schedule.goes_on(2, false));
  one.now = 4.1;
  EXPECT_FALSE(one.schedule.goes_on(2, false));
  // Fewer blocks have no result of their own.
  EXPECT_TRUE(one.schedule.goes_on(1, false));
  EXPECT_FALSE(one.schedule.goes_on(1, true));
  EXPECT_TRUE(one.schedule.is_too_short(1));
  EXPECT_FALSE(one.schedule.is_too_short(2));
}

TEST(PassSchedule, StopsOnRequest) {
  Scheduled one(0);
  EXPECT_FALSE(one.schedule.is_late());
  EXPECT_TRUE(one.schedule.goes_on(2, true));
  one.progress.stop();
  EXPECT_TRUE(one.schedule.is_late());
  EXPECT_FALSE(one.schedule.goes_on(2, true));
  EXPECT_FALSE(one.schedule.goes_on(0, true));
  EXPECT_TRUE(one.schedule.goes_on(0, false));
}

TEST(PassSchedule, GivesFineWallsHalfOfTheTime) {
  // Direct light takes six times as long as that of coarse walls, samples three times.
  Scheduled enough(19), less(17), rays(15);
  EXPECT_TRUE(enough.schedule.has_time_for_fine_walls(1, true));
  EXPECT_EQ(enough.schedule.took.fine_walls, 9);
  EXPECT_EQ(enough.schedule.took.walls, 3);
  EXPECT_FALSE(less.schedule.has_time_for_fine_walls(1, true));
  EXPECT_EQ(less.schedule.took.walls, 1);
  EXPECT_TRUE(rays.schedule.has_time_for_fine_walls(1, false));
}

TEST(PassSchedule, PredictsWhatAFirstPassHasTimeFor) {
  Scheduled one(10);
  one.schedule.took.preview = {0, 0, 1};
  // 57 times the texels take 9.2 seconds, and the walls another one.
  EXPECT_FALSE(one.schedule.has_time_for(57));
  EXPECT_TRUE(one.schedule.has_time_for(40));
  one.now = 7.5;
  EXPECT_TRUE(one.schedule.ends_with_preview());
  one.now = 6.9;
  EXPECT_FALSE(one.schedule.ends_with_preview());
}

}  // namespace
}  // namespace leaflight
