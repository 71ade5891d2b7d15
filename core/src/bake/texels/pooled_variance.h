// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/progress.h"
#include "base/sample_average.h"
#include "field/texel_lattice.h"

namespace leaflight {

// Pools the variance of a sample over each active texel and its neighbors, 3^D texels in all, and
// divides it by the texel's samples. Neighboring texels have similar light. Four blocks alone would
// give a Student's t of three degrees of freedom. A texel whose few samples all missed the light
// would have no variance. A texel without samples gets its neighbors' mean and the variance among
// them.
template <int D>
void pool_variances(const TexelLattice<D>& lattice, std::vector<Average>& averages,
                    Progress& progress);

// Returns the means of texels. A texel without samples gets the mean of its neighbors.
template <int D>
std::vector<Rgb> filled_means(const TexelLattice<D>& lattice, const std::vector<Average>& averages,
                              Progress& progress);

}  // namespace leaflight
