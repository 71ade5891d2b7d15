// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// Vertices lie on the edges of the grid, one for each that is crossed; normals are those of the
// shading gradient, outward, towards lower values. Segments run with the outside on their left, as
// the facets of Mesh<2> have their normal, and so with the inside, the higher values, on their
// right.
struct IsolineMesh {
  std::vector<Vec<2, float>> vertices;  // world
  std::vector<Vec<2, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 2>> segments;
};

// Marching squares that visits only the bricks whose interval holds the isovalue. Alternating
// squares are connected as the bilinear interpolant is (asymptotic decider, Nielson and Hamann
// 1991; the thesis's Fig. 3.11 chooses arbitrarily). Each vertex has at most one segment in and one
// out; a line ends only at the border of the domain or of a masked cell. A value equal to the
// isovalue counts as above it. The result does not depend on the number of threads.
IsolineMesh contour(const Field<2>& field, double isovalue);

}  // namespace leaflight
