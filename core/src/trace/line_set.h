// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/texel_lattice.h"

namespace leaflight {

// Straight lines that cross a lattice of texels plane by plane along one axis. All coordinates are
// in texels. Each coordinate across the axis depends on the plane and on one track, so lines are
// products of tracks. Therefore arithmetic alone finds neighbors that cross the same texel.
template <int D>
struct LineSet {
  // The coordinate of a line across the axis, at z along it: origin + slope z.
  struct Track {
    double origin, slope;

    double at(double z) const { return origin + slope * z; }
  };
  using Tracks = std::array<std::vector<Track>, static_cast<std::size_t>(D - 1)>;

  int axis = 0;
  int step = 1;              // order in which planes are crossed, up or down the axis
  double low = 0, high = 0;  // range of z
  Tracks tracks;             // of the other axes in ascending order
  bool crowded = false;      // true if several lines may cross the same texel of a plane
  double from = 0;           // z of the common point of all lines, if there is one

  std::size_t lines() const {
    std::size_t n = 1;
    for (const auto& of : tracks) n *= of.size();
    return n;
  }
};

// Returns parallel lines, `spacing` texels apart, along a direction in texels. `offset`: shift in
// [0,1).
template <int D>
LineSet<D> parallel_lines(const TexelLattice<D>& lattice, const Vec<D>& direction, int spacing,
                          const std::array<double, 2>& offset);

// Returns lines from a point in texels, in up to 2 D sets, one for each dominant axis and sense.
// They are one texel apart in the farthest plane.
template <int D>
std::vector<LineSet<D>> lines_from(const TexelLattice<D>& lattice, const Vec<D>& point,
                                   const std::array<double, 2>& offset);

}  // namespace leaflight
