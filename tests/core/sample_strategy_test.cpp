// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/sample_strategy.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "field/bump_box.h"
#include "fields.h"
#include "thesis/adaptive_isovalues.h"

namespace leaflight {
namespace {

template <int D>
IsovalueRange whole(const Field<D>& field) {
  return {field.min, field.max};
}

template <int D>
Field<D> bumps(int n) {
  Index<D> dims;
  dims.fill(n);
  return test::field_from<D>(bump_box<D>(n), dims, test::unit_cube<D>(n));
}

template <int D>
std::vector<Vec<D>> positions(const Field<D>& field, SampleStrategy strategy, std::size_t n,
                              std::uint64_t seed = 1) {
  SampleSettings settings;
  settings.strategy = strategy;
  settings.samples = n;
  settings.seed = seed;
  return sample_positions(field, whole(field), settings);
}

double chi_square(const std::vector<int>& counts, double expected) {
  double sum = 0;
  for (const int n : counts) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

// Tests chi-square over 64 bins of [0, extent]^2: 63 degrees of freedom, 99.99 % quantile 113.5.
template <class Position>
void expect_uniform(const std::vector<Vec<2>>& points, Position position) {
  std::vector<int> counts(64);
  for (const Vec<2>& p : points) {
    const Vec<2> x = position(p);
    ++counts[8 * std::min(7, static_cast<int>(x.y * 8)) + std::min(7, static_cast<int>(x.x * 8))];
  }
  EXPECT_LT(chi_square(counts, static_cast<double>(points.size()) / 64), 113.5);
}

TEST(SampleStrategy, UniformIsUniform) {
  const Field<2> field = bumps<2>(33);
  const auto points = positions(field, SampleStrategy::uniform, 64'000);
  ASSERT_EQ(points.size(), 64'000u);
  expect_uniform(points, [](const Vec<2>& p) { return p / 32; });
}

TEST(SampleStrategy, StratifiedHasOnePerStratum) {
  const Field<3> field = bumps<3>(21);
  const auto points = positions(field, SampleStrategy::stratified, 1100);
  ASSERT_EQ(points.size(), 1100u);
  std::map<std::array<int, 3>, int> counts;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = points[i] / 2;
    ++counts[{static_cast<int>(x.x), static_cast<int>(x.y), static_cast<int>(x.z)}];
  }
  EXPECT_EQ(counts.size(), 1000u);
}

TEST(SampleStrategy, StrataFollowTheDomainsProportions) {
  // 40 x 20 voxels, twice as far apart along y, form a square.
  Random random(1);
  std::vector<float> values(41 * 21);
  for (float& h : values) h = static_cast<float>(random.uniform());
  Affine<2> transform;
  transform.column = {Vec<2>(1, 0), Vec<2>(0, 2)};
  const auto field = test::field_from<2>(values, {41, 21}, transform);
  const auto points = positions(field, SampleStrategy::regular, 20'000);
  ASSERT_EQ(points.size(), 141u * 141u);
  EXPECT_NEAR(points[0].x, 20.0 / 141, 1e-12);
  EXPECT_NEAR(points[0].y, 10.0 / 141, 1e-12);
}

// Thesis Eq. 4.12: in proportion to the cells' extents, rounded up; none where h is constant.
TEST(SampleStrategy, ImportanceFollowsTheExtentsOfCells) {
  const Field<2> field = test::sampled<2>(17, [](const Vec<2>& x) {
    return x.x < 0.25 ? 0.0 : (x.x - 0.25) * (x.x - 0.25) * (1 + x.y);
  });
  double sum = 0;
  std::array<double, 256> extent;
  for (int i = 0; i < 256; ++i) {
    const auto h = load_corners<2>(field, {i % 16, i / 16}).h;
    extent[i] = *std::max_element(h.begin(), h.end()) - *std::min_element(h.begin(), h.end());
    sum += extent[i];
  }
  for (const std::size_t n : {std::size_t{100}, std::size_t{40'000}}) {
    const auto points = positions(field, SampleStrategy::importance, n);
    ASSERT_EQ(points.size(), n);
    std::array<int, 256> count{};
    for (const Vec<2>& p : points) ++count[static_cast<int>(p.y) * 16 + static_cast<int>(p.x)];
    for (int i = 0; i < 256; ++i) {
      const double expected = static_cast<double>(n) * extent[i] / sum;
      EXPECT_NEAR(count[i], expected, 2) << "cell " << i << " of " << n;
      if (extent[i] == 0) {
        EXPECT_EQ(count[i], 0);
      } else if (n > 1000) {
        EXPECT_GE(count[i], 1);
      }
    }
    if (n > 1000) {
      expect_uniform(points, [](const Vec<2>& p) {
        return Vec<2>(p.x - std::floor(p.x), p.y - std::floor(p.y));
      });
    }
  }
}

TEST(SampleStrategy, SamplesLieInTheRange) {
  const Field<3> field = bumps<3>(25);
  SampleSettings settings;
  settings.samples = 2000;
  for (const SampleStrategy strategy :
       {SampleStrategy::uniform, SampleStrategy::stratified, SampleStrategy::importance,
        SampleStrategy::level_set, SampleStrategy::letters, SampleStrategy::slabs,
        SampleStrategy::regular}) {
    settings.strategy = strategy;
    EXPECT_THROW(sample_positions(field, {1000, 1001}, settings), Error) << name_of(strategy);
    const auto points = sample_positions(field, {20, 30}, settings);
    EXPECT_GT(points.size(), 300u);
    if (strategy != SampleStrategy::regular) {
      EXPECT_EQ(points.size(), 2000u);
    }
    for (const Vec3& p : points) {
      ASSERT_TRUE(inside(field, p));
      const double h = value_at(field, p);
      ASSERT_TRUE(h >= 20 && h <= 30) << name_of(strategy);
    }
  }
}

TEST(SampleStrategy, NoSampleInMaskedCells) {
  std::vector<float> values = bump_box<2>(17);
  for (int i = 0; i < 60; ++i) values[i * 4] = std::nanf("");
  const auto field = test::field_from<2>(values, {17, 17}, test::unit_cube<2>(17));
  for (const SampleStrategy strategy : {SampleStrategy::uniform, SampleStrategy::stratified,
                                        SampleStrategy::importance, SampleStrategy::level_set}) {
    for (const auto& p : positions(field, strategy, 500)) {
      ASSERT_TRUE(std::isfinite(value_at(field, p))) << name_of(strategy);
    }
  }
}

TEST(SampleStrategy, LevelSetSamplesLieUniformlyOnTheIsosurfaces) {
  const Field<3> field = test::ball<3>(41);
  const IsovalueRange isovalue_range{0.6, 0.9};
  SampleSettings settings;
  settings.strategy = SampleStrategy::level_set;
  settings.samples = 20'000;
  settings.isovalues = 4;
  const std::vector<double> isovalues = adaptive_isovalues(field, isovalue_range, 4);
  std::array<int, 4> count{};
  double area = 0;
  for (const double c : isovalues) area += (1 - c) * (1 - c);
  Vec3 mean(0.0);
  for (const Vec3& p : sample_positions(field, isovalue_range, settings)) {
    const double h = value_at(field, p);
    const auto nearest =
        std::min_element(isovalues.begin(), isovalues.end(),
                         [&](double a, double b) { return std::abs(a - h) < std::abs(b - h); });
    ASSERT_NEAR(h, *nearest, 1e-9);
    ++count[nearest - isovalues.begin()];
    mean += p / 40 - Vec3(0.5);
  }
  for (int i = 0; i < 4; ++i) {
    const double share = std::pow(1 - isovalues[i], 2) / area;
    EXPECT_NEAR(count[i] / 20'000.0, share, 0.02);
  }
  EXPECT_LT((mean / 20'000).length(), 0.01);
}

TEST(SampleStrategy, LevelSetTakesTheIsovaluesItIsGiven) {
  const Field<2> field = test::ball<2>(41);
  SampleSettings settings;
  settings.strategy = SampleStrategy::level_set;
  settings.samples = 1000;
  settings.isovalues = std::vector<double>{0.7, 0.8};
  int low = 0;
  for (const Vec<2>& p : sample_positions(field, {0.6, 0.9}, settings)) {
    const double h = value_at(field, p);
    ASSERT_NEAR(h, h < 0.75 ? 0.7 : 0.8, 1e-9);
    low += h < 0.75;
  }
  // The isolines are circles of radius 0.3 and 0.2.
  EXPECT_NEAR(low, 600, 80);
  EXPECT_THROW(sample_positions(field, {0.75, 0.9}, settings), Error);
  settings.isovalues = std::vector<double>{};
  EXPECT_THROW(sample_positions(field, {0.6, 0.9}, settings), Error);
}

TEST(SampleStrategy, LettersLeaveTheBottomOut) {
  for (const auto& p : positions(bumps<2>(33), SampleStrategy::letters, 5000)) {
    ASSERT_GT(p.y / 32, 0.3);
  }
  for (const auto& p : positions(bumps<3>(17), SampleStrategy::letters, 5000)) {
    ASSERT_GT(p.y / 16, 0.3);
  }
}

TEST(SampleStrategy, SlabsAreDiagonalPlanes) {
  std::map<int, int> count;
  for (const Vec3& p : positions(bumps<3>(33), SampleStrategy::slabs, 5000)) {
    const double mean = (p.x + p.y + p.z) / 96;
    const int slab = static_cast<int>(mean * 5);
    ASSERT_NEAR(mean, (slab + 0.5) / 5, 0.00501);
    ++count[slab];
  }
  EXPECT_EQ(count.size(), 5u);
}

TEST(SampleStrategy, IsAFunctionOfTheSeed) {
  const Field<3> field = bumps<3>(17);
  for (const SampleStrategy strategy :
       {SampleStrategy::uniform, SampleStrategy::importance, SampleStrategy::level_set}) {
    const auto points = positions(field, strategy, 3000);
    std::vector<Vec3> one;
    tbb::task_arena(1).execute([&] { one = positions(field, strategy, 3000); });
    EXPECT_EQ(points, one);
    EXPECT_NE(points, positions(field, strategy, 3000, 2));
  }
}

TEST(SampleStrategy, NamesAreUnique) {
  for (const char* name :
       {"uniform", "stratified", "importance", "level_set", "letters", "slabs", "regular"}) {
    EXPECT_EQ(name_of(sample_strategy_from(name)), name);
  }
  EXPECT_THROW(sample_strategy_from("good"), Error);
}

// Returns the greatest distance in the unit square from a voxel to the nearest of some isolines,
// given by their crossings with the grid's edges.
double widest_gap(const Field<2>& field, const std::vector<double>& isovalues) {
  std::vector<Vec<2>> crossings;
  const auto edge = [&](const Index<2>& i, const Index<2>& j) {
    const double a = field.value(i), b = field.value(j);
    for (const double c : isovalues) {
      if ((a >= c) == (b >= c)) continue;
      const Vec<2> from = to_vector<2>(i), to = to_vector<2>(j);
      crossings.push_back(from + (to - from) * ((c - a) / (b - a)));
    }
  };
  for_each_index<2>({}, field.dims, [&](const Index<2>& i) {
    if (i[0] + 1 < field.dims[0]) edge(i, {i[0] + 1, i[1]});
    if (i[1] + 1 < field.dims[1]) edge(i, {i[0], i[1] + 1});
  });
  double widest = 0;
  for_each_index<2>({}, field.dims, [&](const Index<2>& i) {
    double nearest = 1e9;
    for (const Vec<2>& p : crossings) {
      nearest = std::min(nearest, (p - to_vector<2>(i)).length2());
    }
    widest = std::max(widest, nearest);
  });
  return std::sqrt(widest) / (field.dims[0] - 1);
}

TEST(AdaptiveIsovalues, LieCloserTogetherThanEquallySpacedOnes) {
  const Field<2> field = bumps<2>(65);
  double last = 1;
  for (const int n : {1, 3, 10}) {
    const std::vector<double> adaptive = adaptive_isovalues(field, whole(field), n);
    ASSERT_EQ(static_cast<int>(adaptive.size()), n);
    std::vector<double> equal;
    for (int i = 0; i < n; ++i) {
      equal.push_back(255.0 * (i + 0.5) / n);
      EXPECT_TRUE(adaptive[i] > 0 && adaptive[i] < 255);
      EXPECT_TRUE(i == 0 || adaptive[i] > adaptive[i - 1]);
    }
    const double gap = widest_gap(field, adaptive);
    EXPECT_LT(gap, 0.8 * widest_gap(field, equal)) << n;
    EXPECT_LT(gap, last);
    last = gap;
  }
}

// On a ramp, isosurfaces are as far apart as their isovalues, so they must be equally spaced.
TEST(AdaptiveIsovalues, AreEquallySpacedOnARamp) {
  const auto field = test::sampled<3>(49, [](const Vec3& x) { return x.z; });
  const std::vector<double> isovalues = adaptive_isovalues(field, {0, 1}, 4);
  ASSERT_EQ(isovalues.size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(isovalues[i], (i + 0.5) / 4, 0.05);
}

TEST(AdaptiveIsovalues, BadCountsAndRangesAreErrors) {
  const Field<2> field = bumps<2>(17);
  EXPECT_THROW(adaptive_isovalues(field, {0, 255}, 0), Error);
  EXPECT_THROW(adaptive_isovalues(field, {300, 400}, 3), Error);
}

}  // namespace
}  // namespace leaflight
