// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/components.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "base/sampling.h"
#include "fields.h"

namespace leaflight {
namespace {

Components parts_of(const Field<3>& field, float isovalue) {
  Progress progress;
  return components(field, isovalue, progress);
}

TEST(Components, AreNumberedBySize) {
  const auto field = test::sampled<3>(41, [](const Vec3& x) {
    const double small = 0.1 - (x - Vec3(0.15)).length(), large = 0.3 - (x - Vec3(0.6)).length();
    return std::max(large, small);
  });
  const Components found = parts_of(field, 0);
  ASSERT_EQ(found.sizes.size(), 3u);
  EXPECT_NEAR(static_cast<double>(found.sizes[1]), 4.0 / 3 * pi * 12 * 12 * 12, 200);
  EXPECT_NEAR(static_cast<double>(found.sizes[2]), 4.0 / 3 * pi * 4 * 4 * 4, 30);
  const auto number = [&](int n) { return found.of_voxel[(n * 41 + n) * 41 + n]; };
  EXPECT_EQ(number(24), 1u);
  EXPECT_EQ(number(6), 2u);
  EXPECT_EQ(number(0), 0u);
}

TEST(Components, AreConnectedAcrossFacesOnly) {
  // A checkerboard has only parts of one voxel.
  const auto field = test::sampled<3>(
      4, [](const Vec3& x) { return std::lround(3 * (x[0] + x[1] + x[2])) % 2 == 0 ? 1.0 : 0.0; });
  std::vector<std::uint64_t> sizes(33, 1);
  sizes[0] = 0;
  EXPECT_EQ(parts_of(field, 1).sizes, sizes);
}

TEST(Components, AreDividedByMissingValues) {
  const auto field = test::sampled<3>(5, [](const Vec3& x) {
    return x[0] == 0.5 ? std::numeric_limits<double>::quiet_NaN() : 1 + x[1];
  });
  const Components found = parts_of(field, 1);
  EXPECT_EQ(found.sizes, (std::vector<std::uint64_t>{0, 50, 50}));
  EXPECT_EQ(found.of_voxel[0], 1u);
  EXPECT_EQ(found.of_voxel[2], 0u);
  EXPECT_EQ(found.of_voxel[4], 2u);
}

TEST(Components, StopWhenCancelled) {
  const auto field = test::sampled<3>(5, [](const Vec3& x) { return x[0]; });
  Progress progress;
  progress.cancel();
  EXPECT_THROW(components(field, 0.5f, progress), Cancelled);
}

}  // namespace
}  // namespace leaflight
