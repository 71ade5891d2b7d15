// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

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
  // Of light by lines, in the averages of a bake in rounds; 0 of one with fixed samples.
  int direct_blocks = 0, indirect_blocks = 0;
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

// Is given a whole bake after each round but the last.
template <int D>
using OnRound = std::function<void(Baked<D>&&)>;

// Lights every leaf of the scene's window at once. The result is the same, bit for bit, for any
// number of threads. Throws Error for a bad scene or settings, Cancelled within half a second of
// progress.cancel(). `kept`, if given, is what a bake in rounds goes on with, which is of the same
// scene and settings but for the error and the time. `checkpoints`: of a bake in rounds; a bake
// with fixed samples has none.
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const OnRound<D>& on_round = {}, const KeptLight<D>* kept = nullptr,
              const Checkpoints* checkpoints = nullptr);

// The same with a plan of the caller's.
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
              Progress& progress, const OnRound<D>& on_round = {},
              const KeptLight<D>* kept = nullptr, const Checkpoints* checkpoints = nullptr);

}  // namespace leaflight
