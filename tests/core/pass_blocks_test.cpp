// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/pass_blocks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace leaflight {
namespace {

TEST(PassBlocks, LeaveTheNoiseToReach) {
  // The variance is inversely proportional to the number of blocks.
  for (const int now : {4, 7, 16}) {
    for (const double more : {1.3, 1.6, 1.9}) {
      const int next = next_blocks(now, 1, 1 / more);
      EXPECT_GE(next, more * now);
      EXPECT_LT(next, std::max(more, 1.25) * now + 1);
    }
  }
}

TEST(PassBlocks, AreNeverFewerAndAtMostTwiceAsManyOrEight) {
  EXPECT_EQ(next_blocks(8, 1, 2), 8);
  EXPECT_EQ(next_blocks(2, 1, 0.001), 8);
  EXPECT_EQ(next_blocks(6, 1, 0.001), 12);
  EXPECT_EQ(next_blocks(20, 1, 0.001), 32);
  EXPECT_EQ(next_blocks(50, 1, 0.001), 50);
  EXPECT_EQ(next_blocks(8, INFINITY, 0.001), 16);
}

TEST(PassBlocks, AreNoneWithoutIndirectLight) { EXPECT_EQ(next_blocks(0, 0, 0), 0); }

TEST(PassBlocks, NoiseIsLeftByTheTextureErrorWithinBounds) {
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 0.8), 0.6);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 0), 0.8);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 1), 0.5);
  EXPECT_DOUBLE_EQ(noise_to_reach(1, 4), 2);
  EXPECT_FALSE(is_out_of_reach(1, 0.9));
  EXPECT_TRUE(is_out_of_reach(1, 0.95));
}

}  // namespace
}  // namespace leaflight
