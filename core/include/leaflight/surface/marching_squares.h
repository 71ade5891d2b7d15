// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "leaflight/field/field.h"

namespace leaflight {

// Vertices lie on the edges of the grid; normals are those of the shading gradient, outward,
// towards lower values. Segments have the outside on their left.
struct IsolineMesh {
  std::vector<Vec<2, float>> vertices;  // world
  std::vector<Vec<2, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 2>> segments;
};

// Marching squares: the contour of a field in the plane, with the decisions of marching cubes.
// Open where the leaf meets the border of the domain or a masked cell.
IsolineMesh contour(const Field<2>& field, double isovalue);

}  // namespace leaflight
