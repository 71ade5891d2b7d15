// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace leaflight {

// An edge of a cell. Edges are numbered 4 * axis + place, where the bits of `place` are the offsets
// along the other two axes in ascending order. Corners are numbered as in CellCorners, faces 2 *
// axis + side.
struct CellEdge {
  int axis;
  int corner;  // lower end
};
CellEdge cell_edge(int edge);

// Returns the corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> face_corners(int face);

// Returns the faces whose corners alternate, one bit each. `above`: one bit per corner above the
// isovalue.
unsigned alternating_faces(unsigned above);

// Returns the alternating faces, one bit each, whose two corners above are connected across the
// face. The saddle of the bilinear interpolant decides (asymptotic decider, Nielson and Hamann
// 1991). Both cells of a face get the same result, so the surface has no cracks. g: h - c at the
// corners.
unsigned joined_faces(const std::array<double, 8>& g, unsigned above);

// Returns the closed polygons in which the surface meets the cell's faces. Each is its sequence of
// crossed edges from the lowest one, with the side below on its right seen from outside. joined:
// result of joined_faces().
std::vector<std::vector<int>> cell_polygons(unsigned above, unsigned joined);

}  // namespace leaflight
