// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/sample_average.h"
#include "thesis/fixed_bake.h"

namespace leaflight {

// Returns averages of the lights' direct light on each texel.
template <int D>
std::vector<Average> direct_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels);

// Returns averages of all other light. The estimator is null if there is no indirect light.
template <int D>
std::vector<Average> indirect_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels,
                                   const IndirectEstimator<D>* estimator);

}  // namespace leaflight
