// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>
#include <vector>

namespace leaflight::test {

// Chance that a test of correct code fails with another seed. Seeds are fixed, so a passing test
// keeps passing. With some hundred tests, about one in a hundred changes of the random numbers
// causes a false alarm.
inline constexpr double significance = 1e-4;

// Returns the significance of each of n tests, such that any fails with chance alpha (Sidak 1967).
inline double sidak(double alpha, std::size_t n) {
  return -std::expm1(std::log1p(-alpha) / static_cast<double>(std::max<std::size_t>(1, n)));
}

// Returns the number of standard errors within which normal numbers stay in all of n tests.
inline double z_limit(std::size_t n = 1, double alpha = significance) {
  const boost::math::normal normal;
  return boost::math::quantile(boost::math::complement(normal, sidak(alpha, n) / 2));
}

// Returns the normal quantile with the same tail as t of Student's distribution.
inline double z_of_t(double t, double freedom) {
  const boost::math::students_t student(std::max(freedom, 1.0));
  const double tail = boost::math::cdf(boost::math::complement(student, std::abs(t)));
  if (!(tail > 1e-300)) return std::copysign(38, t);
  return std::copysign(boost::math::quantile(boost::math::complement(boost::math::normal(), tail)),
                       t);
}

// Returns the value that chi-square exceeds in any of n tests with the chance alpha.
inline double chi_square_limit(double freedom, std::size_t n = 1, double alpha = significance) {
  const boost::math::chi_squared distribution(freedom);
  return boost::math::quantile(boost::math::complement(distribution, sidak(alpha, n)));
}

// Tests that counts are a draw from the distribution with the expected counts. Pools bins that
// expect fewer than five (Cochran 1954). A single sample of zero density fails the test.
inline testing::AssertionResult agree(const std::vector<double>& counts,
                                      const std::vector<double>& expected, std::size_t tests = 1) {
  constexpr double fewest = 5;
  double chi_square = 0, rest_count = 0, rest_expected = 0, drawn = 0, bins = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] == 0 && counts[i] > 0) {
      return testing::AssertionFailure()
             << counts[i] << " samples in bin " << i << ", where the density is zero";
    }
    drawn += counts[i];
    if (expected[i] < fewest) {
      rest_count += counts[i];
      rest_expected += expected[i];
      continue;
    }
    chi_square += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
    ++bins;
  }
  if (rest_expected >= fewest) {
    chi_square += (rest_count - rest_expected) * (rest_count - rest_expected) / rest_expected;
    ++bins;
  }
  if (bins < 2) return testing::AssertionFailure() << "too few samples: " << drawn;
  const double limit = chi_square_limit(bins - 1, tests);
  if (chi_square <= limit) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "chi-square of " << chi_square << " exceeds " << limit
                                     << ", " << bins << " bins, " << drawn << " samples";
}

// The counts of points in bins of the unit cube, with equally many bins along each axis.
class Histogram {
 public:
  explicit Histogram(std::vector<int> bins) : bins_(std::move(bins)) {
    std::size_t n = 1;
    for (const int b : bins_) n *= b;
    counts_.assign(n, 0);
  }
  void add(const std::vector<double>& u, double weight = 1) {
    std::size_t bin = 0;
    for (std::size_t a = 0; a < bins_.size(); ++a) {
      const int i = static_cast<int>(std::floor(u[a] * bins_[a]));
      // Rounding may put a number on the border: it belongs to the last bin. Others are outside.
      if (!(u[a] > -1e-6 && u[a] < 1 + 1e-6)) ++outside_;
      bin = bin * bins_[a] + std::clamp(i, 0, bins_[a] - 1);
    }
    counts_[bin] += weight;
    ++drawn_;
  }
  const std::vector<double>& counts() const { return counts_; }

  testing::AssertionResult uniform() const {
    return against([](const std::vector<double>&) { return 1.0; }, 1);
  }
  // Compares the counts with `density`, integrated over each bin at `fine` points along each axis.
  testing::AssertionResult against(const std::function<double(const std::vector<double>&)>& density,
                                   int fine) const {
    if (outside_ > 0) return testing::AssertionFailure() << outside_ << " samples outside";
    std::vector<double> expected(counts_.size(), 0);
    std::size_t parts = 1;
    for (std::size_t a = 0; a < bins_.size(); ++a) parts *= fine;
    std::vector<double> u(bins_.size());
    for (std::size_t bin = 0; bin < expected.size(); ++bin) {
      for (std::size_t part = 0; part < parts; ++part) {
        std::size_t b = bin, p = part;
        for (std::size_t a = bins_.size(); a-- > 0; b /= bins_[a], p /= fine) {
          u[a] = (b % bins_[a] + (p % fine + 0.5) / fine) / bins_[a];
        }
        expected[bin] += density(u);
      }
      expected[bin] *= drawn_ / static_cast<double>(expected.size() * parts);
    }
    double sum = 0;
    for (const double e : expected) sum += e;
    // A density must integrate to 1 within the error of the points.
    if (std::abs(sum / drawn_ - 1) > 0.01) {
      return testing::AssertionFailure() << "the density integrates to " << sum / drawn_;
    }
    for (double& e : expected) e *= drawn_ / sum;
    return agree(counts_, expected);
  }

 private:
  std::vector<int> bins_;
  std::vector<double> counts_;
  double drawn_ = 0;
  std::size_t outside_ = 0;
};

}  // namespace leaflight::test
