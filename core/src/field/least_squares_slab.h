// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/cell_bounds.h"

namespace leaflight {

// The slab about the plane of least squares through the voxels low <= voxel <= high, widened by a
// margin on both sides; infinitely wide where a voxel is masked or the plane leaves so much that
// the slab is not worth a test.
template <int D>
typename CellBounds<D>::Slab least_squares_slab(const Voxels& values, const Index<D>& dims,
                                                const Index<D>& low, const Index<D>& high,
                                                double margin);

}  // namespace leaflight
