// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/bake.h"

namespace leaflight {

// A bake in passes: each adds blocks of an integrator (integrator.h), lines where there is one
// volume without mirrors and glass, else rays, and leaves a whole bake. What a pass does depends
// on the passes before alone, never on time. Ends when the estimated noise leaves room for
// settings.error, when settings.seconds are over or progress.stop() was called. A first picture is
// nothing to go on with, as it has texels of its own. Checkpoints leave its state now and then, and
// it goes on from one of them with the bits of a bake that nobody interrupted.
template <int D>
Baked<D> bake_in_passes(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const BakeHooks<D>& hooks);

}  // namespace leaflight
