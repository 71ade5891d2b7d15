// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/path_light.h"

namespace leaflight {
namespace {

template <int D>
PhotonCaches<D> trace_caustics(const LitScene<D>& scene,
                               const std::vector<TexelLattice<D>>& lattices, std::uint64_t photons,
                               std::uint64_t seed) {
  if (!scene.plan.caustics) return {};
  PhotonSettings settings;
  settings.seed = seed;
  settings.caustic_photons = photons;
  return trace_into_caches(scene.tracer, scene.lights, lattices, settings, scene.plan,
                           scene.progress);
}

}  // namespace

template <int D>
PathLight<D>::PathLight(const LitScene<D>& scene, const std::vector<TexelLattice<D>>& lattices,
                        std::uint64_t photons, std::uint64_t seed)
    : has_caustics_(scene.plan.caustics),
      photons_(trace_caustics(scene, lattices, photons, seed)),
      isosurfaces_(lattices.size()),
      caustics_{isosurfaces_, photons_.walls.get()} {
  for (std::size_t v = 0; has_caustics_ && v < lattices.size(); ++v) {
    isosurfaces_[v] = {&lattices[v], photons_.isosurfaces[v].get()};
  }
  estimator_ =
      make_path_estimator(scene.tracer, scene.lights, has_caustics_ ? &caustics_ : nullptr);
}

template class PathLight<2>;
template class PathLight<3>;

}  // namespace leaflight
