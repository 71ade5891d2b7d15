// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "leaflight/field/field.h"

namespace leaflight {

// Vertices lie on the edges of the grid; normals are those of the shading gradient, outward,
// towards lower values. Triangles are counter-clockwise seen from outside.
struct IsosurfaceMesh {
  std::vector<Vec<3, float>> vertices;  // world
  std::vector<Vec<3, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// Marching cubes (Lorensen and Cline 1987) that visits only the bricks whose interval holds the
// isovalue. Without cracks; open where the leaf meets the border of the domain or a masked cell.
// The result does not depend on the number of threads. Throws Error when there are more than 2^31
// vertices.
IsosurfaceMesh contour(const Field<3>& field, double isovalue);

}  // namespace leaflight
