// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// A cell's edges are numbered 4 * axis + place, where the two bits of `place` are the offsets along
// the other two axes in ascending order. Corners as in CellCorners.
struct CellEdge {
  int axis;
  int corner;  // its lower end
};
CellEdge cell_edge(int edge);

// Which corners of a face, in their order around it, are above the isovalue. Edge i of the face
// goes from corner i to the next.
using FaceSigns = std::array<bool, 4>;

// On a face whose corners alternate, whether the two above are connected across it, given h - c:
// decided by the saddle of the bilinear interpolant (asymptotic decider, Nielson and Hamann 1991).
// False on other faces.
bool joined_across(const std::array<double, 4>& g, const FaceSigns& above);

// Walking around a face, the contour leaves through the edge `leaving`, from above to below; the
// edge, from below to above, through which it returns.
int returning_edge(const FaceSigns& above, int leaving, bool joined);

// The triangles that separate the corners above the isovalue from those below, as edge numbers,
// oriented with the side below, the outside, in front.
struct CellTriangles {
  std::array<std::uint8_t, 30> edge;
  std::uint8_t count;  // triangles
};

// `above`: bit per corner. `joined`: bit per face 2 * axis + side; on a face whose corners
// alternate it says whether the two above are connected across it. Both cells of a face decide
// alike, so the surface has no cracks.
const CellTriangles& cell_triangles(unsigned above, unsigned joined);

// joined_across() for every face, with h - c at the corners of the cell.
unsigned joined_faces(const std::array<double, 8>& g, unsigned above);

}  // namespace leaflight
