// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// The points inside the unit cube, borders left out, at which the gradient of the trilinear
// interpolant of the corners' values vanishes; there are at most two. Where they are not isolated
// there are none.
struct CellSaddles {
  std::array<std::array<double, 3>, 2> point;
  int count = 0;
};
CellSaddles cell_saddles(const std::array<double, 8>& g);

// For each corner the lowest of those that the trilinear interpolant's region of its sign connects
// it with in the cell. g: h - c at the corners; above: bit per corner; joined: of joined_faces();
// saddles: of cell_saddles().
//
// Regions that are apart on the faces meet inside the cell only at a saddle of their sign (Morse
// theory). The interpolant is constant on the three lines through a saddle along the axes, so that
// these join whatever of its sign they meet on the six faces.
std::array<std::uint8_t, 8> connected_corners(const std::array<double, 8>& g, unsigned above,
                                              unsigned joined, const CellSaddles& saddles);

}  // namespace leaflight
