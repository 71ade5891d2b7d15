// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/plan/plan.h"
#include "math/progress.h"
#include "transport/isosurface_cache.h"
#include "transport/surface_cache.h"

namespace leaflight {

// Rays that a photon takes on average, for the progress of a bake.
inline constexpr double rays_per_photon = 3;

// The light of photons on isosurfaces and walls; empty where a bake needs none.
template <int D>
struct PhotonCaches {
  std::vector<std::unique_ptr<IsosurfaceCache<D>>> isosurfaces;  // per volume
  std::unique_ptr<SurfaceCache<D>> walls;
};

struct PhotonSettings {
  std::uint64_t seed = 0;
  std::uint64_t photons = 0, caustic_photons = 0;  // how many the passes trace
  bool density = false;                            // of the photons is looked up with all its noise
  int wall_samples = 0;       // shadow rays of each side of the walls' patches; 0: not looked up
  bool smooth_walls = false;  // their entries are finer, and photons spread over several
};

// Traces the photons, and the caustic photons, that the plan asks for. The lattices, one per
// volume, must live as long as the caches.
template <int D>
PhotonCaches<D> trace_into_caches(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                                  const std::vector<TexelLattice<D>>& lattices,
                                  const PhotonSettings& settings, const Plan& plan,
                                  Progress& progress);

}  // namespace leaflight
