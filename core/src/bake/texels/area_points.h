// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/texels/line_volume.h"

namespace leaflight {

// A random point on the isosurfaces of an isovalue range. `area`: the area that it represents, up
// to a common factor.
template <int D>
struct AreaPoint {
  Vec<D> position;  // index coordinates
  CellPoint<D> at;
  double c;  // common isovalue
  double area;
};

// Returns about one point per texel of a lattice, at most 65,536.
template <int D>
std::vector<AreaPoint<D>> area_points(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                                      std::uint64_t seed);

}  // namespace leaflight
