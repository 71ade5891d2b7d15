// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/baked.h"

namespace leaflight {

// A bake with a given number of samples in each texel, or at each of some scattered points, by the
// estimator that the settings name: what the thesis does, what all scenes can be lit by, and what
// rounds are measured against.
template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const BakeSettings<D>& settings,
                                 const Plan& plan, Progress& progress);

}  // namespace leaflight
