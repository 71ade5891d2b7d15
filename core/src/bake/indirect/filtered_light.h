// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/texel_surface.h"
#include "math/sample_average.h"

namespace leaflight {

// Indirect light at the texels of a lattice: averages with pooled variances (pooled_variance.h),
// and how their halves differ.
struct NoisyLight {
  std::vector<Average> averages;
  std::vector<HalfDifference> halves;
};

// Takes noise from indirect light: each texel moves towards the mean of its neighbours on about the
// same isosurface, if it faces the same way there. How far, two halves of the blocks decide, whose
// noise is independent (Rousselle et al. 2012): what both halves would change alike is light, the
// rest is noise, and the step is the longer, the more of it is noise (shrinkage, James and Stein
// 1961). So more blocks mean less filtering, and the result goes to the truth; and texels of few
// samples go further than those about them. Variances become those of the results, with what the
// step changes of the light itself counted as error. `sides`: the front and the back one, which is
// empty where it is not baked; their halves are empty afterwards.
template <int D>
void filter_along_isosurfaces(const IndexedLattice<D>& texels,
                              const std::vector<TexelSurface<D>>& surfaces,
                              std::array<NoisyLight, 2>& sides, Progress& progress);

}  // namespace leaflight
