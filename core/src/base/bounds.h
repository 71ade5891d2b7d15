// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace leaflight {

// Largest distance of world coordinates from the origin; its inverse is the least length of a
// voxel's edge. All inputs are checked, so that later computations do not overflow. Embree, which
// uses single precision, supports at most 3e18.
constexpr double farthest = 1e18;

// True if all components are within the bounds; false for NaN.
template <class V>
bool within_bounds(const V& v) {
  for (unsigned a = 0; a < V::dimensions(); ++a) {
    if (!(std::abs(v[a]) <= farthest)) return false;
  }
  return true;
}

}  // namespace leaflight
