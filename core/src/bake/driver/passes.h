// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/bake.h"

namespace leaflight {

// Bakes in passes; each adds blocks of an integrator (integrator.h) and leaves a complete bake. One
// volume without mirrors and glass uses lines, all other scenes use rays. A pass depends only on
// the passes before it, never on time. The bake ends when its estimated error reaches
// settings.error, when settings.seconds are over, or at progress.stop(). A first picture cannot be
// continued, because it has its own texels. Checkpoints save the state at intervals. A bake that
// continues from one has the bits of an uninterrupted bake.
template <int D>
Baked<D> bake_in_passes(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const BakeHooks<D>& hooks);

}  // namespace leaflight
