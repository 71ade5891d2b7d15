// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/sample_average.h"
#include "thesis/fixed_bake.h"

namespace leaflight {

// The lights' direct light on some texels, averages of each.
template <int D>
std::vector<Average> direct_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels);

// All other light on them. The estimator may be null where there is no indirect light.
template <int D>
std::vector<Average> indirect_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels,
                                   const IndirectEstimator<D>* estimator);

}  // namespace leaflight
