// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace leaflight {

// Samples indices in proportion to their weights.
class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  explicit DiscreteDistribution(std::vector<double> weights) : cumulative_(std::move(weights)) {
    for (double& c : cumulative_) c = total_ += c;
    for (double& c : cumulative_) c /= total_ > 0 ? total_ : 1;
  }

  struct Pick {
    std::size_t index;
    double probability;
    double rest;  // uniform in [0,1) again
  };
  // Samples an index. `u`: in [0,1). Precondition: not empty.
  Pick pick(double u) const {
    const std::size_t i =
        std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u) - cumulative_.begin();
    const double p = probability(i);
    const double rest = p > 0 ? (u - below(i)) / p : 0;
    return {i, p, std::clamp(rest, 0.0, 0x1.fffffffffffffp-1)};
  }
  double probability(std::size_t i) const { return cumulative_[i] - below(i); }
  double total() const { return total_; }
  std::size_t size() const { return cumulative_.size(); }
  bool empty() const { return cumulative_.empty(); }

 private:
  double below(std::size_t i) const { return i > 0 ? cumulative_[i - 1] : 0; }

  std::vector<double> cumulative_;  // the last is 1
  double total_ = 0;
};

}  // namespace leaflight
