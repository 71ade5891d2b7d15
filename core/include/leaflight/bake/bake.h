// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

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
  double noise_percent = 0, error_percent = 0;
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
// progress.cancel().
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const OnRound<D>& on_round = {});

// The same with a plan of the caller's.
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
              Progress& progress, const OnRound<D>& on_round = {});

}  // namespace leaflight
