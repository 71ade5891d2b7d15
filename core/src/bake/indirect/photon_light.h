// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "bake/indirect/photon_caches.h"
#include "bake/texels/checkpoint.h"

namespace leaflight {

// The light of photons that lines look up: on the walls, and on the backs of white isosurfaces if
// no lines gather for them.
template <int D>
class PhotonLight {
 public:
  // `texels`: those that collect photons. `wall_samples`: shadow rays per patch of the walls.
  PhotonLight(TexelLattice<D> texels, int wall_samples)
      : lattices_{std::move(texels)}, wall_samples_(wall_samples) {}

  void trace(const SceneTracer<D>& tracer, const LightSampler<D>& lights, const Plan& plan,
             std::uint64_t photons, std::uint64_t seed, Progress& progress);
  void serialize(Archive archive, const SceneTracer<D>& tracer);

  // Returns the light of backs at the texels of another lattice.
  std::vector<Rgb> backs(const TexelLattice<D>& texels) const;
  // Returns the light of the walls; null before photons are traced.
  const SurfaceCache<D>* walls() const { return walls_.get(); }

 private:
  std::vector<TexelLattice<D>> lattices_;  // one
  int wall_samples_;
  std::vector<Rgb> backs_;  // at its texels
  std::unique_ptr<SurfaceCache<D>> walls_;
};

}  // namespace leaflight
