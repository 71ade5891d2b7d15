// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/texel_surface.h"
#include "base/sample_average.h"

namespace leaflight {

// Indirect light at the texels of a lattice: averages with pooled variances (pooled_variance.h),
// and the differences of their halves.
struct NoisyLight {
  std::vector<Average> averages;
  std::vector<HalfDifference> halves;
};

// Filters noise from indirect light. Each texel moves towards the mean of its neighbors on about
// the same isosurface with a similar normal. Two halves of the blocks, whose noise is independent,
// determine the step (Rousselle et al. 2012). A change that both halves share is light; the rest is
// noise. The step grows with the share of noise (shrinkage, James and Stein 1961). More blocks
// therefore mean less filtering, and the result converges to the truth. Texels with few samples
// move further than their neighbors. Updates the variances, which then include the bias of the
// step. `sides`: front and back; the back is empty if it is not baked. Clears the halves.
template <int D>
void filter_along_isosurfaces(const IndexedLattice<D>& texels,
                              const std::vector<TexelSurface<D>>& surfaces,
                              std::array<NoisyLight, 2>& sides, Progress& progress);

}  // namespace leaflight
