// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/texel_lattice.h"
#include "math/progress.h"
#include "math/sample_average.h"

namespace leaflight {

// Samples of a texel are averaged in so many blocks (see Moments).
inline constexpr int blocks_per_texel = 4;

// Gives each active texel the variance that a sample has in it and in its neighbours, 3^D in all,
// over its own number of samples. Four blocks alone would make a Student's t of three degrees of
// freedom, and a texel none of whose few samples reached the light would have no variance;
// neighbouring texels are lit alike.
//
// A texel that isosurfaces reach somewhere, but in which no sample was found, takes its neighbours'
// mean and the variance among them.
template <int D>
void pool_variances(const TexelLattice<D>& lattice, std::vector<Average>& averages,
                    Progress& progress);

// The means of texels. One without samples has the mean of its neighbours.
template <int D>
std::vector<Rgb> filled_means(const TexelLattice<D>& lattice, const std::vector<Average>& averages,
                              Progress& progress);

}  // namespace leaflight
