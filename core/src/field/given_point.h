// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// Largest distance in voxels beyond the border of a point given in world coordinates. Points on the
// border may be outside by rounding, of their coordinates or of the transform to the index.
inline constexpr double border_rounding = 1e-3;

// True if such a point is inside the field; locate() moves it into the domain.
template <int D>
bool holds_given(const Field<D>& field, const Vec<D>& index_position) {
  for (int a = 0; a < D; ++a) {
    const double p = index_position[a];
    if (!(p >= -border_rounding && p <= field.dims[a] - 1 + border_rounding)) return false;
  }
  return true;
}

}  // namespace leaflight
