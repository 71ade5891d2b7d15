// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/plan/plan.h"
#include "base/progress.h"
#include "transport/isosurface_cache.h"
#include "transport/surface_cache.h"

namespace leaflight {

// Average number of rays per photon, for the progress of a bake.
inline constexpr double rays_per_photon = 3;

// The light of photons on isosurfaces and walls; empty if a bake needs none.
template <int D>
struct PhotonCaches {
  std::vector<std::unique_ptr<IsosurfaceCache<D>>> isosurfaces;  // per volume
  std::unique_ptr<SurfaceCache<D>> walls;
};

struct PhotonSettings {
  std::uint64_t seed = 0;
  std::uint64_t photons = 0, caustic_photons = 0;  // numbers of photons
  bool variance = false;                           // true if the variances of the caches are needed
  int wall_samples = 0;       // shadow rays per side of a wall's patch; 0: no lookups
  bool smooth_walls = false;  // true for finer entries, where photons spread over several
};

// Traces the photons and caustic photons that the plan needs. The lattices, one per volume, must
// outlive the caches.
template <int D>
PhotonCaches<D> trace_into_caches(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                                  const std::vector<TexelLattice<D>>& lattices,
                                  const PhotonSettings& settings, const Plan& plan,
                                  Progress& progress);

}  // namespace leaflight
