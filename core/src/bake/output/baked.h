// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/radiance_grid.h"
#include "bake/plan/plan.h"
#include "bake/texels/isovalue_error.h"
#include "bake/walls/wall_radiance.h"

namespace leaflight {

struct BakeStatistics {
  double seconds = 0;
  std::uint64_t rays = 0;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<SkippedPass> skipped;
  int passes = 1;
  int blocks = 0;  // averaged blocks of indirect light
  double noise_percent = 0, error_percent = 0;
  WorstIsovalue worst;     // of the isosurfaces
  bool stopped = false;    // true if time or the caller ended it before the target error
  bool continued = false;  // true if it contains the light of a previous bake
};

template <int D>
struct Baked {
  std::vector<RadianceGrid<D>> grids;  // one per volume
  WallRadiance<D> walls;
  BakeStatistics statistics;
};

}  // namespace leaflight
