// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/sample_average.h"

namespace leaflight {

// Sums of weighted samples, in consecutive blocks of `block`, a power of two. The variance is that
// of the blocks' means. Samples of a low-discrepancy sequence are not independent; their own
// variance would be several times too large. Each block is a net (Owen 1997). Blocks are slightly
// dependent too, so the variance is an overestimate.
class Moments {
 public:
  explicit Moments(int block = 1) : block_(static_cast<std::uint32_t>(std::max(1, block))) {}

  void add(const Rgb& sample, double weight) {
    const Imath::V3d weighted = Imath::V3d(sample) * weight;
    sum_ += weighted;
    weight2_ += weight * weight;
    open_.weight += weight;
    open_.sum += (weighted.x + weighted.y + weighted.z) / 3;
    if (++count_ % block_ == 0) close();
  }
  std::uint32_t count() const { return count_; }
  Average average() const {
    Moments all = *this;
    if (count_ % block_ != 0) all.close();
    return all.block_average();
  }

 private:
  struct Block {
    double weight = 0, sum = 0;
  };
  void close() {
    weight_ += open_.weight;
    block_weight2_ += open_.weight * open_.weight;
    block_mixed_ += open_.weight * open_.sum;
    block_sum2_ += open_.sum * open_.sum;
    open_ = {};
  }
  Average block_average() const {
    if (!(weight_ > 0)) return {};
    const Imath::V3d mean = sum_ / weight_;
    const double m = (mean.x + mean.y + mean.z) / 3, weight2 = weight_ * weight_;
    // The residuals of the ratio of sums (Cochran 1977, 6.4). The fitted mean makes them too small
    // by the factor 1 - 1 / n for n blocks of equal weight.
    const double residuals = block_sum2_ - 2 * m * block_mixed_ + m * m * block_weight2_;
    const double left = 1 - block_weight2_ / weight2;
    const double variance = left > 1e-3 ? std::max(0.0, residuals) / (weight2 * left) : 0;
    return {Rgb(mean), static_cast<float>(variance), static_cast<float>(weight2 / weight2_)};
  }

  std::uint32_t block_, count_ = 0;
  Block open_;
  Imath::V3d sum_{0};
  double weight_ = 0, weight2_ = 0;
  double block_weight2_ = 0, block_mixed_ = 0, block_sum2_ = 0;
};

}  // namespace leaflight
