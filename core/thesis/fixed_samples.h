// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/baked.h"
#include "base/progress.h"
#include "thesis/fixed_settings.h"

namespace leaflight {

template <int D>
Plan make_plan(const Scene<D>& scene, const FixedSettings<D>& settings);

// Bakes with a given number of samples in each texel, or at each of some scattered points, by the
// estimator of the settings. This is the thesis's method, a reference for bakes in passes. The
// result is the same, bit for bit, for any number of threads. Throws Error for a bad scene or
// settings. Throws Cancelled within half a second of progress.cancel().
template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 Progress& progress);

// Bakes with the caller's plan.
template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 const Plan& plan, Progress& progress);

}  // namespace leaflight
