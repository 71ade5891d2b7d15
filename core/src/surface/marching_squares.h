// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// The lines of an isovalue in 2D. Vertices lie on the edges of the grid, one per crossed edge.
// Normals are those of the shading gradient, outward, towards lower values. Segments have the
// outside on their left, like the facets of Mesh<2>, and the higher values on their right.
struct IsolineMesh {
  std::vector<Vec<2, float>> vertices;  // world
  std::vector<Vec<2, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 2>> segments;
};

// Contours a 2D field by marching squares. Visits only bricks whose interval contains the isovalue.
// Connects alternating squares like the bilinear interpolant (asymptotic decider, Nielson and
// Hamann 1991; the thesis's Fig. 3.11 chooses arbitrarily). Each vertex has at most one segment in
// and one out. Lines end only at the border of the domain or of a masked cell. A value equal to the
// isovalue counts as above it. The result does not depend on the number of threads.
IsolineMesh contour(const Field<2>& field, double isovalue);

}  // namespace leaflight
