// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/texel_lattice.h"

namespace leaflight {

// Straight lines that cross a lattice of texels plane by plane along one axis. All coordinates are
// in texels. Across the axis a line's coordinates depend on the plane and on one number each, so
// that lines are products of tracks: whether a neighbour comes to the same texel is known without
// looking at it.
template <int D>
struct LineSet {
  // A line's coordinate across the axis, at coordinate z along it: origin + slope z.
  struct Track {
    double origin, slope;

    double at(double z) const { return origin + slope * z; }
  };
  using Tracks = std::array<std::vector<Track>, static_cast<std::size_t>(D - 1)>;

  int axis = 0;
  int step = 1;              // the order, up or down the axis, in which the planes are passed
  double low = 0, high = 0;  // of z: where the lines run
  Tracks tracks;             // of the other axes in ascending order
  bool crowded = false;      // several lines may come to the same texel of a plane
  double from = 0;           // z of the point that all lines come from, where there is one

  std::size_t lines() const {
    std::size_t n = 1;
    for (const auto& of : tracks) n *= of.size();
    return n;
  }
};

// Parallel lines, `spacing` texels apart, of a direction in texels; `offset` in [0,1) places them.
template <int D>
LineSet<D> parallel_lines(const TexelLattice<D>& lattice, const Vec<D>& direction, int spacing,
                          const std::array<double, 2>& offset);

// Lines from a point, in texels, in up to 2 D sets, one for each axis and sense that lines run
// along mostly. In the farthest plane they are a texel apart.
template <int D>
std::vector<LineSet<D>> lines_from(const TexelLattice<D>& lattice, const Vec<D>& point,
                                   const std::array<double, 2>& offset);

}  // namespace leaflight
