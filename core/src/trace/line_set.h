// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/texel_lattice.h"

namespace leaflight {

// Straight lines that cross a lattice of texels plane by plane along one axis. All coordinates are
// in texels. A line is one track for each other axis; all combinations of tracks are lines.
template <int D>
struct LineSet {
  // The coordinate of a line across the axis, at z along it: origin + slope z.
  struct Track {
    double origin, slope;

    double at(double z) const { return origin + slope * z; }
  };
  using Tracks = std::array<std::vector<Track>, static_cast<std::size_t>(D - 1)>;

  int axis = 0;
  Tracks tracks;  // along the other axes, in ascending order

  std::size_t lines() const {
    std::size_t n = 1;
    for (const auto& axis_tracks : tracks) n *= axis_tracks.size();
    return n;
  }
};

// Returns parallel lines, `spacing` texels apart, along a direction in texels. `offset`: shift in
// [0,1).
template <int D>
LineSet<D> parallel_lines(const TexelLattice<D>& lattice, const Vec<D>& direction, int spacing,
                          const std::array<double, 2>& offset);

}  // namespace leaflight
