// SPDX-License-Identifier: GPL-3.0-or-later
// Tests reported variances against the true variances over many random keys.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "bake/texels/pooled_variance.h"
#include "bake/texels/texel_moments.h"
#include "base/low_discrepancy.h"
#include "statistics.h"
#include "thesis/moments.h"
#include "transport/flux_accumulator.h"

namespace leaflight {
namespace {

constexpr int repeats = test::sanitized ? 1000 : 4000, samples = 32;

// Over many averages: the variance of the mean, the mean of the reported variance, and their
// errors.
struct Variances {
  double true_mean, true_error, reported_mean, reported_error;
};
template <class Draw>
Variances variances(int block, double expected, Draw draw) {
  double square = 0, square2 = 0, reported = 0, reported2 = 0;
  Random keys(1);
  for (int r = 0; r < repeats; ++r) {
    const std::uint64_t key = keys.bits();
    Moments moments(block);
    for (int i = 0; i < samples; ++i) {
      const auto [value, weight] = draw(key, i);
      moments.add(Rgb(static_cast<Real>(value)), weight);
    }
    const Average a = moments.average();
    const double deviation2 = std::pow(average(a.mean) - expected, 2);
    square += deviation2 / repeats;
    square2 += deviation2 * deviation2 / repeats;
    reported += a.variance / repeats;
    reported2 += static_cast<double>(a.variance) * a.variance / repeats;
  }
  return {square, std::sqrt((square2 - square * square) / repeats), reported,
          std::sqrt((reported2 - reported * reported) / repeats)};
}

using Sample = std::pair<double, double>;  // value and weight

// The reported variance must be right for independent samples and any block size.
TEST(Moments, ReportTheVarianceOfIndependentSamples) {
  for (const int block : {1, 8}) {
    const Variances v = variances(block, 0.5, [](std::uint64_t key, int i) {
      return Sample{Random(key, 0, i).uniform(), 1};
    });
    EXPECT_NEAR(v.true_mean, 1 / 12.0 / samples, test::z_limit(4) * v.true_error);
    EXPECT_NEAR(v.reported_mean, 1 / 12.0 / samples, test::z_limit(4) * v.reported_error);
  }
}

// With weights independent of the values, a ratio has about the variance sum w^2 / (sum w)^2. The
// formula is of first order, so the test allows a tenth.
TEST(Moments, ReportTheVarianceOfARatio) {
  const Variances v = variances(1, 0.5, [](std::uint64_t key, int i) {
    Random random(key, 0, i);
    const double value = random.uniform();
    return Sample{value, std::pow(random.uniform(), 4)};
  });
  EXPECT_NEAR(v.reported_mean / v.true_mean, 1,
              0.1 + test::z_limit(2) * std::hypot(v.true_error, v.reported_error) / v.true_mean);
}

// Blocks of a low-discrepancy sequence must reveal most of its lower variance, but never report too
// little.
TEST(Moments, SeeTheSequenceByItsBlocks) {
  const auto smooth = [](std::uint64_t key, int i) {
    const auto u = sobol_point(i, key);
    return Sample{std::exp(u[0] + u[1]), 1};
  };
  const double expected = std::pow(std::exp(1) - 1, 2);
  const Variances naive = variances(1, expected, smooth), blocks = variances(8, expected, smooth);
  EXPECT_LT(10 * blocks.reported_mean, naive.reported_mean);
  EXPECT_GT(blocks.reported_mean + test::z_limit(2) * blocks.reported_error,
            blocks.true_mean - test::z_limit(2) * blocks.true_error);
}

TEST(Moments, CountSamplesByTheirWeights) {
  Moments moments(4);
  for (int i = 0; i < 10; ++i) moments.add(Rgb(1, 2, 6), i < 5 ? 2 : 0);
  EXPECT_FLOAT_EQ(moments.average().samples, 5);
  EXPECT_FLOAT_EQ(moments.average().mean.z, 6);
  EXPECT_FLOAT_EQ(moments.average().variance, 0);
  EXPECT_EQ(Moments().average().samples, 0);
}

// The sum of squared fluxes is the variance of the sum of a Poisson-distributed number of them.
TEST(FluxAccumulator, KnowsItsVariance) {
  constexpr std::uint64_t photons = 1000;
  double sum = 0, sum2 = 0, reported = 0;
  Random random(2);
  for (int r = 0; r < repeats; ++r) {
    FluxAccumulator flux(1, 3, photons, true);
    double total = 0;
    for (std::uint64_t p = 0; p < photons; ++p) {
      // One photon in a hundred arrives.
      if (random.uniform() > 0.01) continue;
      const double f = 1 + 2 * random.uniform();
      flux.add(0, Rgb(static_cast<Real>(f)));
      total += f;
    }
    EXPECT_NEAR(flux.flux(0, 1), total, 1e-4 * total);
    sum += total / repeats;
    sum2 += total * total / repeats;
    reported += flux.variance(0) / repeats;
  }
  // The variance of a variance is 2 / n of its square. The photons have a fixed number, so they are
  // slightly dependent, which costs 1 %.
  EXPECT_NEAR(reported / (sum2 - sum * sum), 1, 0.01 + test::z_limit() * std::sqrt(2.0 / repeats));
}

TEST(PooledVariance, IsThatOfTheNeighborsSamples) {
  const Field<3> field = test::sampled<3>(5, [](const Vec3& x) { return x.z; });
  const TexelLattice<3> lattice = make_lattice(field, {5, 5, 5}, -1, 2);
  std::vector<Average> averages(lattice.active.size());
  for (std::size_t s = 0; s < averages.size(); ++s) {
    // The texel in the middle has fewer samples.
    averages[s] = {Rgb(static_cast<Real>(s % 2)), 0.5f, 10};
  }
  const auto middle = static_cast<std::size_t>(lattice.slot[lattice.linear({2, 2, 2})]);
  const auto empty = static_cast<std::size_t>(lattice.slot[lattice.linear({4, 4, 4})]);
  averages[middle].samples = 1;
  averages[middle].variance = 0;
  averages[empty] = {};
  Progress progress;
  pool_variances(lattice, averages, progress);
  EXPECT_FLOAT_EQ(averages[0].variance, 0.5f);
  // One sample has ten times the variance of a mean of ten.
  EXPECT_FLOAT_EQ(averages[middle].variance, 5);
  // Four of the corner's seven neighbors have odd numbers and three even ones, or vice versa.
  const double share = averages[empty].mean.x;
  EXPECT_TRUE(std::abs(share - 3 / 7.0) < 1e-6 || std::abs(share - 4 / 7.0) < 1e-6) << share;
  EXPECT_FLOAT_EQ(averages[empty].variance, static_cast<float>(12 / 49.0));
}

TEST(TexelMoments, FreeTheMemoryOfSumsThatAreReleased) {
  TexelMoments moments(1000);
  moments.open();
  EXPECT_EQ(moments.sums.size(), 1000);
  moments.release();
  EXPECT_EQ(moments.sums.capacity(), 0);
}

}  // namespace
}  // namespace leaflight
