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

// Decides the alternating faces by the saddle of the bilinear interpolant (asymptotic decider,
// Nielson and Hamann 1991), with h - c at the corners.
unsigned joined_faces(const std::array<double, 8>& g, unsigned above);

}  // namespace leaflight
