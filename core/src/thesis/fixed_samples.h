// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/baked.h"
#include "math/progress.h"
#include "thesis/fixed_settings.h"

namespace leaflight {

template <int D>
Plan make_plan(const Scene<D>& scene, const FixedSettings<D>& settings);

// A bake with a given number of samples in each texel, or at each of some scattered points, by the
// estimator of the settings: the way of the thesis, with which bakes in passes are compared. The
// result is the same, bit for bit, for any number of threads. Throws Error for a bad scene or
// settings, Cancelled within half a second of progress.cancel().
template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 Progress& progress);

// The same with a plan of the caller's.
template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 const Plan& plan, Progress& progress);

}  // namespace leaflight
