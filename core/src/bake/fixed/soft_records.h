// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/fixed/fixed_bake.h"
#include "math/sample_average.h"

namespace leaflight {

// Soft light gathered at the points of a coarser lattice, as for a white leaf, and interpolated
// (an irradiance cache after Ward et al. 1988, with records on a lattice). A record serves
// spacing^D texels, and so affords spacing^2 times the samples of one.
template <int D>
std::vector<Average> soft_from_records(FixedBake<D>& bake, const LeafTexels<D>& texels,
                                       const IndirectEstimator<D>& estimator);

}  // namespace leaflight
