// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace leaflight {

// World coordinates are at most this far from the origin, and a voxel's edges at least so long as
// its inverse: what enters is held to it, so that nothing behind overflows. Embree, whose numbers
// are of single precision, takes 3e18 at most.
constexpr double farthest = 1e18;

// False for what is not a number, too.
template <class V>
bool within_bounds(const V& v) {
  for (unsigned a = 0; a < V::dimensions(); ++a) {
    if (!(std::abs(v[a]) <= farthest)) return false;
  }
  return true;
}

}  // namespace leaflight
