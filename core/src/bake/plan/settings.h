// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "math/vector.h"

namespace leaflight {

template <int D>
struct BakeSettings {
  Index<D> resolution{};  // texels; all zero: as fine as the volume needs and its size allows
  double error = 1.5;     // the RMS error of colours to reach, in percent
  double seconds = 0;     // that it may take; 0: no limit
  std::uint64_t seed = 0;
  int threads = 0;          // 0: all
  double exposure = 1;      // radiance times this is a displayed colour, whose differences count
  bool both_sides = false;  // the back's radiance too, where light can reach it
  bool walls = false;       // the radiance of the walls too, per common isovalue
};

// Throw Error for numbers that make no sense.
template <int D>
void validate(const BakeSettings<D>& settings);
void validate_threads(int threads);

}  // namespace leaflight
