// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/empty_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "agreement.h"

namespace leaflight {
namespace {

constexpr double below = 0.5;

// Returns a volume that is empty except for a ball in a corner.
Field<3> corner_ball() {
  return test::sampled<3>(41, [](const Vec3& x) { return 1 - 2 * x.length(); });
}

TEST(EmptySpace, HoldsNoVoxelThatLinesNeed) {
  const Field<3> field = corner_ball();
  const EmptySpace<3> empty(field, below);
  EXPECT_LT(empty.value(), below);
  std::size_t held = 0;
  for_each_index<3>({0, 0, 0}, field.dims, [&](const Index<3>& voxel) {
    if (!empty.holds(voxel)) return;
    ++held;
    Index<3> first, last;
    for (int a = 0; a < 3; ++a) {
      first[a] = std::max(0, voxel[a] - EmptySpace<3>::brick_width);
      last[a] = std::min(voxel[a] + EmptySpace<3>::brick_width + 1, field.dims[a]);
    }
    for_each_index<3>(first, last,
                      [&](const Index<3>& near) { ASSERT_LT(field.value(near), below); });
  });
  // Most of the volume must be empty.
  EXPECT_GT(held, field.voxels() / 2);
  EXPECT_LT(held, field.voxels());
}

TEST(EmptySpace, HoldsNothingAtOrAboveTheValue) {
  const Field<3> field = test::sampled<3>(17, [](const Vec3& x) { return below + x.x; });
  const EmptySpace<3> empty(field, below);
  EXPECT_FALSE(empty.holds({8, 8, 8}));
}

TEST(EmptySpace, HoldsNoMaskedVoxel) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Field<3> field =
      test::sampled<3>(33, [&](const Vec3& x) { return x.x > 0.9 ? nan : 0.1 * x.y; });
  const EmptySpace<3> empty(field, below);
  EXPECT_TRUE(empty.holds({2, 2, 2}));
  EXPECT_FALSE(empty.holds({31, 2, 2}));
}

}  // namespace
}  // namespace leaflight
