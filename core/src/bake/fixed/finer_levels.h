// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/fixed/fixed_bake.h"
#include "bake/output/radiance_grid.h"

namespace leaflight {

// Adds texels of half the width, again and again, where light varies most, to the grid of a volume,
// whose lattice it gives it. The estimator may be null where there is no soft light.
template <int D>
void add_finer_levels(FixedBake<D>& bake, int volume, const IndirectEstimator<D>* estimator,
                      RadianceGrid<D>& grid);

}  // namespace leaflight
