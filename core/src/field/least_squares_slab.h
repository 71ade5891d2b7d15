// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/cell_bounds.h"

namespace leaflight {

// Returns the slab around the least-squares plane through the voxels low <= voxel <= high, widened
// by a margin on both sides. It is infinite if a voxel is masked, or if the slab would be too wide
// to pay off.
template <int D>
typename CellBounds<D>::Slab least_squares_slab(const Voxels& values, const Index<D>& dims,
                                                const Index<D>& low, const Index<D>& high,
                                                double margin);

}  // namespace leaflight
