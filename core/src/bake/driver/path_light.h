// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/lit_scene.h"
#include "bake/indirect/photon_caches.h"
#include "bake/texels/point_sampler.h"

namespace leaflight {

// Samples all light except that of light points by paths. Photons carry caustics if the plan asks
// for them. Estimates with different seeds are independent.
template <int D>
class PathLight {
 public:
  // `lattices`: texels that collect photons, for each volume. They and the scene must outlive it.
  PathLight(const LitScene<D>& scene, const std::vector<TexelLattice<D>>& lattices,
            std::uint64_t photons, std::uint64_t seed);
  PathLight(const PathLight&) = delete;

  const IndirectEstimator<D>& estimator() const { return *estimator_; }
  // Returns a sampler. `lights`: sources of its direct light.
  PointSampler<D> sampler(const LightSampler<D>& lights) const {
    return {lights, isosurfaces_, photons_.walls.get(), has_caustics_};
  }

 private:
  bool has_caustics_;
  PhotonCaches<D> photons_;
  std::vector<IsosurfaceRadiance<D>> isosurfaces_;
  CausticPhotons<D> caustics_;
  std::unique_ptr<IndirectEstimator<D>> estimator_;
};

}  // namespace leaflight
