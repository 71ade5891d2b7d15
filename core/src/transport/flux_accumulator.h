// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/vector.h"

namespace leaflight {

// Sums of photon flux in 64-bit fixed point. Integer sums do not depend on the order, so they are
// the same for any number of threads. The variance of a sum is the sum of squared fluxes, averaged
// over the channels. Photons are nearly independent, so their number follows Poisson's
// distribution.
class FluxAccumulator {
 public:
  // `photon_flux`: largest flux with which a photon starts. `photons`: their number. `squares`:
  // true if variance() is needed.
  FluxAccumulator(std::size_t cells, double photon_flux, std::uint64_t photons,
                  bool squares = false)
      : sums_(3 * cells),
        squares_(squares ? cells : 0),
        // All photons may fall into one cell, each with up to `most` times its initial flux.
        unit_(photon_flux * most * static_cast<double>(photons) / 0x1p62),
        limit_(photon_flux * most),
        unit2_(unit_ * limit_) {}

  void add(std::size_t cell, const Rgb& flux) {
    for (int i = 0; i < 3; ++i) {
      const double f = std::min(static_cast<double>(flux[i]), limit_);
      sums_[3 * cell + i].fetch_add(std::llrint(f / unit_), std::memory_order_relaxed);
    }
    if (squares_.empty()) return;
    const double mean = std::min(static_cast<double>(average(flux)), limit_);
    squares_[cell].fetch_add(std::llrint(mean * mean / unit2_), std::memory_order_relaxed);
  }
  bool has_variance() const { return !squares_.empty(); }
  double variance(std::size_t cell) const {
    return static_cast<double>(squares_[cell].load(std::memory_order_relaxed)) * unit2_;
  }
  double flux(std::size_t cell, int channel) const {
    return static_cast<double>(sums_[3 * cell + channel].load(std::memory_order_relaxed)) * unit_;
  }
  bool lit(std::size_t cell) const {
    return sums_[3 * cell].load(std::memory_order_relaxed) != 0 ||
           sums_[3 * cell + 1].load(std::memory_order_relaxed) != 0 ||
           sums_[3 * cell + 2].load(std::memory_order_relaxed) != 0;
  }
  bool empty() const { return sums_.empty(); }

 private:
  // Only the factor of shading normals increases a photon's flux above its initial value.
  static constexpr double most = 64;

  std::vector<std::atomic<std::int64_t>> sums_, squares_;
  double unit_;
  double limit_;
  double unit2_;  // of the squares
};

}  // namespace leaflight
