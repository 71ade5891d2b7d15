// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// How far beyond the border, in voxels, a point may lie that was given in world coordinates: on
// the border it does by rounding, its own in single precision or that of the map to the index.
inline constexpr double border_rounding = 1e-3;

// The same as inside() for the index position of such a point; locate() moves it into the domain.
template <int D>
bool holds_given(const Field<D>& field, const Vec<D>& index_position) {
  for (int a = 0; a < D; ++a) {
    const double p = index_position[a];
    if (!(p >= -border_rounding && p <= field.dims[a] - 1 + border_rounding)) return false;
  }
  return true;
}

}  // namespace leaflight
