// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/bake.h"

namespace leaflight {

// Whether a scene can be baked in rounds: one volume of diffuse leaves, no mirrors, no glass.
template <int D>
bool fits_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan);

// A bake in rounds: each sweeps more lines through the volume, for direct and soft light as much as
// their noise and cost ask for, and leaves a whole bake, which `on_round` is given for each round
// but the last. What a round does depends on the rounds before alone, never on time. Ends when the
// estimated noise leaves room for settings.error, when settings.seconds are over or progress.stop()
// was called.
template <int D>
Baked<D> bake_in_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const OnRound<D>& on_round);

}  // namespace leaflight
