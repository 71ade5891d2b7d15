// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/indirect/block_workers.h"
#include "bake/indirect/previous_light.h"
#include "bake/output/baked.h"
#include "bake/texels/checkpoint.h"
#include "math/progress.h"

namespace leaflight {

// What a bake has to do with others.
template <int D>
struct BakeHooks {
  // Is given a whole bake after each pass but the last.
  std::function<void(Baked<D>&&)> on_pass;
  // What the bake goes on with, of each volume, of the same scene and settings but for the error
  // and the time.
  const std::vector<PreviousLight<D>>* previous = nullptr;
  const Checkpoints* checkpoints = nullptr;
  const BlockWorkers* workers = nullptr;
  // Of the time that settings.seconds limits, as TimeLimit has it.
  std::function<double()> clock = nullptr;
};

// Lights every isosurface of the scene's isovalue range at once. The result is the same, bit for
// bit, for any number of threads, and of workers. Throws Error for a bad scene or settings,
// Cancelled within half a second of progress.cancel().
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const BakeHooks<D>& hooks = {});

}  // namespace leaflight
