// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/indirect/previous_light.h"
#include "bake/output/baked.h"
#include "bake/plan/workers.h"
#include "bake/texels/checkpoint.h"
#include "base/progress.h"

namespace leaflight {

// Callbacks and optional inputs of a bake.
template <int D>
struct BakeHooks {
  // Receives a complete bake after each pass except the last.
  std::function<void(Baked<D>&&)> on_pass;
  // The light of a previous bake for each volume, which this bake continues. Scene and settings
  // must be equal, except for the target error and the time.
  const std::vector<PreviousLight<D>>* previous = nullptr;
  const Checkpoints* checkpoints = nullptr;
  const Workers* workers = nullptr;
  // The clock of settings.seconds; see TimeLimit.
  std::function<double()> clock = nullptr;
};

// Lights every isosurface of the scene's isovalue range at once. The result is the same, bit for
// bit, for any number of threads and workers. Throws Error for a bad scene or settings. Throws
// Cancelled within half a second of progress.cancel().
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const BakeHooks<D>& hooks = {});

}  // namespace leaflight
