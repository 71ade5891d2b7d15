// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// The triangles that separate the corners of a cell above the isovalue from those below. The side
// below, the outside, is in front. The mesh of all cells is a manifold. Within a cell, each side of
// a triangle belongs to two triangles, or to one if it lies on a face. No other side joins two
// points of one face, where the next cell could have the same side. If the points on edges do not
// suffice, there are points inside the cell.
struct CellTriangles {
  // Three corners per triangle: an edge of the cell, or from 12 on a point inside it.
  const std::uint8_t* corner = nullptr;
  std::uint8_t count = 0;   // triangles
  std::uint8_t inside = 0;  // points inside the cell
};

// Returns the triangles by the corners above the isovalue, one bit each. There are none for
// ambiguous cases, where a face alternates or a tunnel is possible.
const std::array<CellTriangles, 256>& plain_triangles();

// Returns the triangles of an ambiguous case, with the topology of the trilinear interpolant. g: h
// - c at the corners.
const CellTriangles& ambiguous_triangles(unsigned above, const std::array<double, 8>& g);

}  // namespace leaflight
