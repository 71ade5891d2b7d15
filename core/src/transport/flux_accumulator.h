// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "math/vector.h"

namespace leaflight {

// Sums of photon flux in 64-bit fixed point: integers add up alike in any order, so the sums are
// the same for any number of threads. The squares of the fluxes' means over their colours are the
// variance of a sum: photons fall independently, nearly, so that their number is Poisson's.
class FluxAccumulator {
 public:
  // `photon_flux`: the largest flux with which a photon starts; `photons`: how many there are;
  // `squares`: whether variance() will be asked for.
  FluxAccumulator(std::size_t cells, double photon_flux, std::uint64_t photons,
                  bool squares = false)
      : sums_(3 * cells),
        squares_(squares ? cells : 0),
        // All photons may fall into one cell, each with up to `most` times its first flux.
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
  // Only the factor of shading normals lets a photon's flux exceed the one with which it started.
  static constexpr double most = 64;

  std::vector<std::atomic<std::int64_t>> sums_, squares_;
  double unit_;
  double limit_;
  double unit2_;  // of the squares
};

}  // namespace leaflight
