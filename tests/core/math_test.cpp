// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/low_discrepancy.h"
#include "base/random.h"
#include "base/ranked_set.h"
#include "fields.h"

namespace leaflight {
namespace {

// Each elementary interval of area 2^-k must contain one of the first 2^k points.
TEST(Sobol, IsAZeroTwoSequence) {
  for (std::uint64_t seed : {1ull, 99ull, 0x123456789abcdefull}) {
    for (int log2_n = 0; log2_n <= 10; ++log2_n) {
      for (int split = 0; split <= log2_n; ++split) {
        std::set<std::pair<int, int>> boxes;
        for (std::uint32_t i = 0; i < (1u << log2_n); ++i) {
          const auto p = sobol_point(i, seed);
          boxes.insert({static_cast<int>(p[0] * (1 << split)),
                        static_cast<int>(p[1] * (1 << (log2_n - split)))});
        }
        ASSERT_EQ(boxes.size(), std::size_t{1} << log2_n);
      }
    }
  }
}

TEST(Affine, InverseUndoesIt) {
  Affine<3> m;
  m.column = {Vec3(2, 0.5, 0), Vec3(-1, 3, 0.2), Vec3(0, 0.1, -0.7)};
  m.origin = Vec3(100, -20, 3);
  const Vec3 p(0.3, -4, 7);
  EXPECT_LT((inverse(m).point(m.point(p)) - p).length(), 1e-12);
  Affine<2> flat;
  flat.column = {Vec<2>(2, 1), Vec<2>(-1, 3)};
  flat.origin = Vec<2>(5, 6);
  EXPECT_LT((inverse(flat).point(flat.point({0.3, -4})) - Vec<2>(0.3, -4)).length(), 1e-12);
}

TEST(RankedSet, KnowsWhatItHoldsAndItsPlace) {
  Random random(11);
  for (const std::size_t bound : {1u, 63u, 64u, 65u, 1000u, 4096u}) {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t n = 0; n < bound; ++n) {
      if (random.uniform() < 0.4 || n % 500 > 400) numbers.push_back(n);
    }
    const RankedSet set(bound, numbers);
    ASSERT_EQ(set.bound(), bound);
    std::int32_t rank = 0;
    for (std::uint32_t n = 0; n < bound; ++n) {
      const bool holds = std::binary_search(numbers.begin(), numbers.end(), n);
      ASSERT_EQ(set[n], holds ? rank++ : RankedSet::absent) << n << " of " << bound;
      if (n + 1 == bound) break;
      ASSERT_EQ(set.two_from(n), (std::array{set[n], set[n + 1]}));
    }
  }
}

TEST(LargeArray, LiesInAFileBeyondTheLimit) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const LargeMemory before = large_memory();
  constexpr std::size_t count = 3 << 20;
  {
    limit_large_memory(before.in_memory + count, folder);
    LargeArray<std::uint8_t> first(count, 1), second(count, 2), small(100, 3);
    second.resize(2 * count, 4);
    EXPECT_EQ(large_memory().in_memory, before.in_memory + count);
    EXPECT_EQ(large_memory().in_files, before.in_files + 2 * count);
    EXPECT_EQ(second.front() + second.back() + first.back() + small.back(), 10);
    const LargeArray<std::uint8_t> moved = std::move(second);
    EXPECT_EQ(moved.size(), 2 * count);
  }
  limit_large_memory(0, folder);
  EXPECT_EQ(large_memory().in_memory, before.in_memory);
  EXPECT_EQ(large_memory().in_files, before.in_files);
}

TEST(LargeArray, RefusesAFolderThatIsNotThere) {
  limit_large_memory(1, "/no/such/folder");
  EXPECT_THROW(LargeArray<float>(1 << 20), Error);
  limit_large_memory(0, "/no/such/folder");
  EXPECT_EQ(LargeArray<float>(1 << 20).size(), 1u << 20);
}

}  // namespace
}  // namespace leaflight
