// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace leaflight {

// A cell's edges are numbered 4 * axis + place, where the two bits of `place` are the offsets along
// the other two axes in ascending order. Corners as in CellCorners. Faces are numbered
// 2 * axis + side.
struct CellEdge {
  int axis;
  int corner;  // its lower end
};
CellEdge cell_edge(int edge);

// The corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> face_corners(int face);

// Which corners are above the isovalue, bit by bit, alternate on these faces, bit by bit.
unsigned alternating_faces(unsigned above);

// The alternating faces, bit by bit, on which the two corners above are connected across the face,
// by the saddle of the bilinear interpolant (asymptotic decider, Nielson and Hamann 1991). Both
// cells of a face decide alike, so the surface has no cracks. g: h - c at the corners.
unsigned joined_faces(const std::array<double, 8>& g, unsigned above);

// The closed polygons in which the surface meets the cell's faces, each as the edges that it
// crosses in turn, from its lowest one on, with the side below on its right seen from outside.
// joined: of joined_faces().
std::vector<std::vector<int>> cell_polygons(unsigned above, unsigned joined);

}  // namespace leaflight
