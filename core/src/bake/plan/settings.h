// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/vector.h"

namespace leaflight {

template <int D>
struct BakeSettings {
  Index<D> resolution{};  // texels; zeros: chosen by the detail and the size of the volume
  double error = 1.5;     // target RMS error of colors, in percent
  double seconds = 0;     // time limit; 0: none
  std::uint64_t seed = 0;
  int threads = 0;          // 0: all
  double exposure = 1;      // factor from radiance to displayed color, for the error
  bool both_sides = false;  // bakes the back's radiance too, where light can reach it
  bool walls = false;       // bakes the radiance of the walls too, per common isovalue
};

// Throws Error for invalid numbers.
template <int D>
void validate(const BakeSettings<D>& settings);
void validate_threads(int threads);

}  // namespace leaflight
