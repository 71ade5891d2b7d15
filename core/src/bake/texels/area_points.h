// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/texels/line_volume.h"

namespace leaflight {

// A random point of the isosurfaces of an isovalue range. `area`: how much of them it stands for,
// up to a factor that all points share.
template <int D>
struct AreaPoint {
  Vec<D> position;  // index
  CellPoint<D> at;
  double c;  // the common isovalue
  double area;
};

// About one for each texel of a lattice, 65,536 at most.
template <int D>
std::vector<AreaPoint<D>> area_points(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                                      std::uint64_t seed);

}  // namespace leaflight
