// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/cell_crossing.h"

#include <gtest/gtest.h>

namespace leaflight {
namespace {

TEST(CellCrossing, ConstantCellsHaveNoCrossing) {
  CellCorners<3> corners;
  corners.h.fill(3.0);
  const Vec3 from(0.25, 0, 0.5), to(1.0);
  EXPECT_FALSE(first_crossing(along_segment<3>(corners, 2.0, from, to), true));
  EXPECT_FALSE(first_crossing(along_segment<3>(corners, 4.0, from, to), false));
  EXPECT_FALSE(first_crossing(along_segment<3>(corners, 3.0, from, to), true))
      << "h == c everywhere counts as above";
}

TEST(CellCrossing, TouchingFromAboveIsNoCrossing) {
  // (s - 1/2)^2 touches zero, which counts as above.
  EXPECT_FALSE(first_crossing({0.25, -1, 1, 0}, true));
  // -(s - 1/2)^2 reaches zero from below: the touching point is above.
  const auto touch = first_crossing({-0.25, 1, -1, 0}, false);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(*touch, 0.5, 1e-7);  // a double root has half of the digits
}

TEST(CellCrossing, ThreeRootsGiveTheFirst) {
  // (s - 0.1)(s - 0.5)(s - 0.9)
  const auto found = first_crossing({-0.045, 0.59, -1.5, 1}, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.1, 1e-15);
}

TEST(CellCrossing, GivenSideWinsOverRounding) {
  // The starting side is given as above, although the polynomial is below from its first point on.
  const auto found = first_crossing({-1e-18, -1, 0, 0}, true);
  ASSERT_TRUE(found);
  EXPECT_LT(*found, 1e-15);
}

}  // namespace
}  // namespace leaflight
