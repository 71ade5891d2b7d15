// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/vector.h"
#include "surface/cell_triangles.h"

namespace leaflight {

// Where the n-th point inside a cell lies, in the unit cube: on the isosurface of the trilinear
// interpolant, near the middle of the edges' points about it. g: h - c at the corners.
Vec3 point_inside(const CellTriangles& triangles, int n, const std::array<double, 8>& g);

}  // namespace leaflight
