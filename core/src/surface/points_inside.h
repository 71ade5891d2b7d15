// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/vector.h"
#include "surface/cell_triangles.h"

namespace leaflight {

// Returns the n-th point inside a cell, in the unit cube. It is on the isosurface of the trilinear
// interpolant, near the center of the surrounding points on edges. g: h - c at the corners.
Vec3 point_inside(const CellTriangles& triangles, int n, const std::array<double, 8>& g);

}  // namespace leaflight
