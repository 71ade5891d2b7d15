// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/scattered.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numeric>

#include "base/error.h"
#include "fields.h"

namespace leaflight {
namespace {

// Returns n^D active texels, two voxels apart.
template <int D>
TexelLattice<D> full_lattice(int n) {
  Index<D> dims, resolution;
  dims.fill(2 * n - 1);
  resolution.fill(n);
  TexelLattice<D> lattice = inactive_lattice<D>(dims, resolution);
  std::vector<std::uint32_t> all(lattice.texels());
  std::iota(all.begin(), all.end(), 0);
  lattice.activate(std::move(all));
  return lattice;
}

template <int D>
std::vector<Vec<D>> random_positions(int n, double extent, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec<D>> positions(n);
  for (Vec<D>& p : positions) {
    for (int a = 0; a < D; ++a) p[a] = extent * random.uniform();
  }
  return positions;
}

template <int D>
ScatteredTexels interpolate(const TexelLattice<D>& lattice, const std::vector<Vec<D>>& positions,
                            const std::vector<Rgb>& values, ScatteredFilter filter, int radius) {
  Progress progress;
  return interpolate_scattered(lattice, positions, values, {filter, radius}, progress);
}

constexpr std::array<ScatteredFilter, 3> filters{ScatteredFilter::shepard, ScatteredFilter::tent,
                                                 ScatteredFilter::box};

template <class Dimension>
class Scattered : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Scattered, Dimensions);

// Weights sum to one, so constants are exact, also in gaps.
TYPED_TEST(Scattered, IsExactOnConstants) {
  constexpr int D = TypeParam::value;
  const TexelLattice<D> lattice = full_lattice<D>(9);
  const auto positions = random_positions<D>(30, 16, 1);
  const std::vector<Rgb> values(positions.size(), Rgb(0.25f, 1, 3));
  for (const ScatteredFilter filter : filters) {
    for (const int radius : {0, 1, 3, 20}) {
      const ScatteredTexels texels = interpolate(lattice, positions, values, filter, radius);
      for (const Rgb& v : texels.value) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(v[k], values[0][k], 1e-6);
      }
      for (const float e : texels.error) EXPECT_NEAR(e, 0, 1e-5);
    }
  }
}

TYPED_TEST(Scattered, ShepardReproducesASampleOnATexel) {
  constexpr int D = TypeParam::value;
  const TexelLattice<D> lattice = full_lattice<D>(9);
  auto positions = random_positions<D>(2000, 16, 2);
  std::vector<Rgb> values(positions.size(), Rgb(1));
  positions[700] = Vec<D>(8.0);
  values[700] = Rgb(5, 6, 7);
  Index<D> middle;
  middle.fill(4);
  for (const int radius : {1, 4, 100}) {
    const ScatteredTexels texels =
        interpolate(lattice, positions, values, ScatteredFilter::shepard, radius);
    EXPECT_EQ(texels.value[lattice.linear(middle)], Rgb(5, 6, 7)) << radius;
  }
}

// Compares with the weighted sums, computed directly.
TYPED_TEST(Scattered, IsTheWeightedMeanOfTheSamplesInReach) {
  constexpr int D = TypeParam::value;
  const TexelLattice<D> lattice = full_lattice<D>(7);
  const auto positions = random_positions<D>(300, 12, 3);
  std::vector<Rgb> values;
  Random random(4);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    values.emplace_back(static_cast<Real>(random.uniform()), Real(i % 5), Real(1));
  }
  for (const ScatteredFilter filter : filters) {
    constexpr int radius = 2;
    const ScatteredTexels texels = interpolate(lattice, positions, values, filter, radius);
    for (std::size_t t = 0; t < lattice.texels(); ++t) {
      const Index<D> texel = lattice.texel(static_cast<std::uint32_t>(t));
      Vec<3> sum(0.0);
      double weights = 0;
      unsigned count = 0;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        const Vec<D> offset = positions[i] / 2 - to_vector<D>(texel);
        bool reaches = true;
        for (int a = 0; a < D; ++a) {
          reaches &= std::abs(std::lround(positions[i][a] / 2) - texel[a]) <= radius;
        }
        const double d = offset.length();
        const double w = filter == ScatteredFilter::shepard ? std::pow(d, -5)
                         : filter == ScatteredFilter::tent  ? std::max(0.0, 1 - d / (radius + 0.5))
                                                            : 1;
        if (!reaches || !(w > 0)) continue;
        sum += Vec<3>(values[i]) * w;
        weights += w;
        ++count;
      }
      ASSERT_EQ(texels.count[t], count);
      ASSERT_GT(count, 0u);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(texels.value[t][k], sum[k] / weights, 1e-5);
    }
  }
}

template <int D>
double error_with(int samples) {
  const TexelLattice<D> lattice = full_lattice<D>(D == 2 ? 33 : 13);
  const double extent = 2.0 * (lattice.resolution[0] - 1);
  const auto smooth = [&](const Vec<D>& p) {
    double v = 1;
    for (int a = 0; a < D; ++a) v += std::sin(4 * p[a] / extent + a);
    return v;
  };
  const auto positions = random_positions<D>(samples, extent, 5);
  std::vector<Rgb> values;
  for (const Vec<D>& p : positions) values.emplace_back(static_cast<Real>(smooth(p)));
  const ScatteredTexels texels =
      interpolate(lattice, positions, values, ScatteredFilter::shepard, 1);
  double square = 0;
  for (std::size_t t = 0; t < lattice.texels(); ++t) {
    const Vec<D> p = to_vector<D>(lattice.texel(static_cast<std::uint32_t>(t))) * 2;
    square += std::pow(texels.value[t].x - smooth(p), 2);
  }
  return std::sqrt(square / static_cast<double>(lattice.texels()));
}

TYPED_TEST(Scattered, ErrorOfASmoothFunctionFallsWithTheSamples) {
  constexpr int D = TypeParam::value;
  const int few = D == 2 ? 500 : 1000;
  double last = error_with<D>(few);
  for (const int factor : {8, 64}) {
    const double now = error_with<D>(factor * few);
    EXPECT_LT(now, 0.7 * last);
    last = now;
  }
}

// Samples cover only one half; the other half must take the values at its edge.
TYPED_TEST(Scattered, GapsTakeTheNearestTexels) {
  constexpr int D = TypeParam::value;
  const TexelLattice<D> lattice = full_lattice<D>(9);
  std::vector<Vec<D>> positions;
  std::vector<Rgb> values;
  for (std::size_t t = 0; t < lattice.texels(); ++t) {
    const Index<D> texel = lattice.texel(static_cast<std::uint32_t>(t));
    if (texel[0] > 4) continue;
    positions.push_back(to_vector<D>(texel) * 2);
    values.emplace_back(static_cast<Real>(texel[1]), static_cast<Real>(texel[0]), Real(0));
  }
  const ScatteredTexels texels = interpolate(lattice, positions, values, ScatteredFilter::box, 0);
  for (std::size_t t = 0; t < lattice.texels(); ++t) {
    const Index<D> texel = lattice.texel(static_cast<std::uint32_t>(t));
    EXPECT_EQ(texels.count[t], texel[0] > 4 ? 0u : 1u);
    EXPECT_EQ(texels.value[t],
              Rgb(static_cast<Real>(texel[1]), static_cast<Real>(std::min(4, texel[0])), 0));
  }
}

TEST(Scattered2D, GapsBetweenEquallyNearTexelsTakeTheirMean) {
  const TexelLattice<2> lattice = full_lattice<2>(5);
  const ScatteredTexels texels =
      interpolate<2>(lattice, {{0, 4}, {8, 4}}, {Rgb(1), Rgb(3)}, ScatteredFilter::tent, 0);
  EXPECT_EQ(texels.value[lattice.linear({1, 2})], Rgb(1));
  EXPECT_EQ(texels.value[lattice.linear({2, 4})], Rgb(2));
}

// A wide Shepard filter reaches across gaps without filling, but not beyond its radius.
TEST(Scattered2D, WideShepardFiltersReachAcrossGaps) {
  const TexelLattice<2> lattice = full_lattice<2>(41);
  const auto positions = random_positions<2>(500, 30, 7);
  const std::vector<Rgb> values(positions.size(), Rgb(1));
  const ScatteredTexels all =
      interpolate(lattice, positions, values, ScatteredFilter::shepard, 566);
  for (const std::uint32_t n : all.count) EXPECT_EQ(n, 64u);
  const ScatteredTexels some =
      interpolate(lattice, positions, values, ScatteredFilter::shepard, 12);
  EXPECT_EQ(some.count[lattice.linear({40, 40})], 0u);
  EXPECT_GT(some.count[lattice.linear({24, 24})], 0u);
}

// The standard error of a mean of n values of spread s is s / sqrt(n).
TEST(Scattered2D, StandardErrorIsThatOfTheMean) {
  const TexelLattice<2> lattice = full_lattice<2>(9);
  const auto positions = random_positions<2>(40'000, 16, 8);
  std::vector<Rgb> values;
  Random random(9);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    values.emplace_back(static_cast<Real>(random.uniform()));
  }
  const ScatteredTexels texels = interpolate(lattice, positions, values, ScatteredFilter::box, 0);
  for (std::size_t t = 0; t < lattice.texels(); ++t) {
    EXPECT_NEAR(texels.error[t] * std::sqrt(texels.count[t]), 1 / std::sqrt(12), 0.04);
  }
}

TEST(Scattered3D, IsTheSameForAnyNumberOfThreads) {
  const TexelLattice<3> lattice = full_lattice<3>(17);
  const auto positions = random_positions<3>(3000, 32, 10);
  std::vector<Rgb> values;
  for (const Vec3& p : positions) values.emplace_back(Rgb(p));
  for (const int radius : {1, 30}) {
    const ScatteredTexels all =
        interpolate(lattice, positions, values, ScatteredFilter::shepard, radius);
    ScatteredTexels one;
    tbb::task_arena(1).execute(
        [&] { one = interpolate(lattice, positions, values, ScatteredFilter::shepard, radius); });
    EXPECT_EQ(all.value, one.value);
    EXPECT_EQ(all.error, one.error);
  }
}

TEST(Scattered2D, BadSettingsAreErrors) {
  const TexelLattice<2> lattice = full_lattice<2>(5);
  EXPECT_THROW(interpolate<2>(lattice, {}, {}, ScatteredFilter::box, 1), Error);
  EXPECT_THROW(interpolate<2>(lattice, {{0, 0}}, {}, ScatteredFilter::box, 1), Error);
  EXPECT_THROW(interpolate<2>(lattice, {{0, 0}}, {Rgb(1)}, ScatteredFilter::box, -1), Error);
  EXPECT_THROW(interpolate<2>(lattice, {{0, 0}}, {Rgb(1)}, ScatteredFilter::tent, 100), Error);
  EXPECT_EQ(scattered_filter_from("tent"), ScatteredFilter::tent);
  EXPECT_THROW(scattered_filter_from("gauss"), Error);
}

}  // namespace
}  // namespace leaflight
