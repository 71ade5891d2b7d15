// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "leaflight/math/vector.h"

namespace leaflight {

// Mean of samples and the variance of that mean, of the mean over its colours.
struct Average {
  Rgb mean{0};
  float variance = 0;
};

// Sums of weighted samples.
class Moments {
 public:
  void add(const Rgb& sample, double weight) {
    const double m = leaflight::average(sample), weight2 = weight * weight;
    ++count_;
    weight_ += weight;
    sum_ += Imath::V3d(sample) * weight;
    weight2_ += weight2;
    mean2_ += weight2 * m;
    square2_ += weight2 * m * m;
  }
  std::uint32_t count() const { return count_; }
  Average average() const {
    if (!(weight_ > 0)) return {};
    const Imath::V3d mean = sum_ / weight_;
    const double m = (mean.x + mean.y + mean.z) / 3, n = count_;
    const double spread = square2_ - 2 * m * mean2_ + m * m * weight2_;
    const double variance = std::max(0.0, spread) / (weight_ * weight_);
    return {Rgb(mean), count_ > 1 ? static_cast<float>(variance * n / (n - 1)) : 0};
  }

 private:
  std::uint32_t count_ = 0;
  Imath::V3d sum_{0};
  double weight_ = 0, weight2_ = 0, mean2_ = 0, square2_ = 0;
};

}  // namespace leaflight
