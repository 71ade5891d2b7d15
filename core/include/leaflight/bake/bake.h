// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "leaflight/bake/block_workers.h"
#include "leaflight/bake/checkpoint.h"
#include "leaflight/bake/kept_light.h"
#include "leaflight/bake/leaf_error.h"
#include "leaflight/bake/plan.h"
#include "leaflight/bake/radiance_grid.h"
#include "leaflight/bake/surroundings_radiance.h"
#include "leaflight/math/progress.h"

namespace leaflight {

struct BakeStatistics {
  double seconds = 0;
  std::uint64_t rays = 0;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<SkippedPass> skipped;
  int rounds = 1;
  // Of indirect light, in the averages of a bake in rounds; 0 of one with fixed samples.
  int blocks = 0;
  double noise_percent = 0, error_percent = 0;
  WorstLeaf worst;       // of the isosurfaces, where there are rounds
  bool stopped = false;  // by time or by the caller, before the error was reached
};

template <int D>
struct Baked {
  std::vector<RadianceGrid<D>> grids;  // one per volume
  SurroundingsRadiance<D> surroundings;
  BakeStatistics statistics;
};

// What a bake in rounds has to do with others; bakes with fixed samples have nothing of it.
template <int D>
struct BakeHooks {
  // Is given a whole bake after each round but the last.
  std::function<void(Baked<D>&&)> on_round;
  // What the bake goes on with, of each volume, of the same scene and settings but for the error
  // and the time.
  const std::vector<KeptLight<D>>* kept = nullptr;
  const Checkpoints* checkpoints = nullptr;
  const BlockWorkers* workers = nullptr;
};

// Lights every leaf of the scene's window at once. The result is the same, bit for bit, for any
// number of threads, and of workers. Throws Error for a bad scene or settings, Cancelled within
// half a second of progress.cancel().
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const BakeHooks<D>& hooks = {});

// The same with a plan of the caller's.
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
              Progress& progress, const BakeHooks<D>& hooks = {});

}  // namespace leaflight
