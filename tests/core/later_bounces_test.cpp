// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/later_bounces.h"

#include <gtest/gtest.h>

namespace leaflight {
namespace {

TEST(LaterBounces, SumTheGeometricSeries) {
  const std::vector<Rgb> before{{1, 2, 0}, {3, 6, 0}}, last{{0.5, 1, 0}, {1.5, 0, 0}};
  const Rgb later = later_bounces(before, last);
  EXPECT_NEAR(later[0], 1, 1e-6);        // 1/2 + 1/4 + 1/8 + ...
  EXPECT_NEAR(later[1], 1.0 / 7, 1e-6);  // mean of 0.5 after a mean of 4
  EXPECT_EQ(later[2], 0);
}

TEST(LaterBounces, EndWhereChanceMakesOneBrighter) {
  const Rgb later = later_bounces({Rgb(1)}, {Rgb(3)});
  EXPECT_NEAR(later[0], 4, 1e-5);  // 4/5 + 16/25 + ...
}

TEST(LaterBounces, AreNoneOfNoTexels) { EXPECT_EQ(later_bounces({}, {}), Rgb(0)); }

}  // namespace
}  // namespace leaflight
