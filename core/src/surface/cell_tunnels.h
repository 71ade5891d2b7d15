// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// The points inside the open unit cube where the gradient of the trilinear interpolant vanishes; at
// most two. There are none if such points are not isolated.
struct CellSaddles {
  std::array<std::array<double, 3>, 2> point;
  int count = 0;
};
CellSaddles cell_saddles(const std::array<double, 8>& g);

// Returns, for each corner, the lowest corner in the same region of the trilinear interpolant.
// Its inputs are h - c at the corners, `above` with one bit per corner, and the results of
// joined_faces() and cell_saddles().
//
// Regions that are separate on the faces meet inside the cell only at a saddle of their sign (Morse
// theory). The interpolant is constant on the three axis-parallel lines through a saddle. So these
// lines join all regions of the saddle's sign that they hit on the six faces.
std::array<std::uint8_t, 8> connected_corners(const std::array<double, 8>& g, unsigned above,
                                              unsigned joined, const CellSaddles& saddles);

}  // namespace leaflight
