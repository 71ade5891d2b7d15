// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// The triangles that separate the corners of a cell above the isovalue from those below, oriented
// with the side below, the outside, in front.
//
// The mesh of all cells is a manifold: within a cell each side of a triangle belongs to two of
// them, or to one where it lies on a face, and no other side joins two points of one face, where
// the next cell could do the same. Where edges' points alone do not suffice there are points inside
// the cell.
struct CellTriangles {
  // Three for each triangle: an edge of the cell, or from 12 on a point inside it.
  const std::uint8_t* corner = nullptr;
  std::uint8_t count = 0;   // triangles
  std::uint8_t inside = 0;  // points inside the cell
};

// By the corners above the isovalue, bit by bit; none where these do not decide, since some face
// alternates or the surface could have a tunnel.
const std::array<CellTriangles, 256>& plain_triangles();

// For those, with the topology of the trilinear interpolant. g: h - c at the corners.
const CellTriangles& ambiguous_triangles(unsigned above, const std::array<double, 8>& g);

}  // namespace leaflight
