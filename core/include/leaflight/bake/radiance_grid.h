// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "leaflight/bake/plan.h"
#include "leaflight/field/texel_lattice.h"

namespace leaflight {

struct BakeStatistics {
  double seconds = 0;
  std::uint64_t rays = 0;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<SkippedPass> skipped;
};

// The outer side's radiance [W/(m^2 sr)] at the active texels, in the order of `lattice.active`.
template <int D>
struct RadianceGrid {
  TexelLattice<D> lattice;
  std::vector<Vec<3, float>> radiance;
  std::vector<Vec<3, float>> radiance_indirect;  // the part that has bounced before
  std::vector<float> radiance_error;             // standard error of the mean over the channels
  BakeStatistics statistics;
};

// Linear along each axis, over the active texels only; zero where there is none.
template <int D>
Vec<3, float> lookup(const RadianceGrid<D>& grid, const Vec<D>& index_position);

}  // namespace leaflight
