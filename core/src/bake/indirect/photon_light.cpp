// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/photon_light.h"

#include "bake/indirect/indirect_light.h"
#include "base/parallel.h"

namespace leaflight {

template <int D>
void PhotonLight<D>::trace(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                           const Plan& plan, std::uint64_t photons, std::uint64_t seed,
                           Progress& progress) {
  PhotonSettings settings;
  settings.seed = seed;
  settings.photons = photons;
  settings.wall_samples = wall_samples_;
  settings.smooth_walls = true;
  PhotonCaches<D> caches = trace_into_caches(tracer, lights, lattices_, settings, plan, progress);
  walls_ = std::move(caches.walls);
  backs_.clear();
  if (plan.back) return;
  const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
  backs_.resize(lattices_[0].active.size());
  parallel_each(backs_.size(), [&](std::size_t s) {
    backs_[s] = caches.isosurfaces[0]->irradiance(static_cast<std::int32_t>(s), true) * brdf;
  });
}

template <int D>
void PhotonLight<D>::serialize(Archive archive, const SceneTracer<D>& tracer) {
  archive(backs_, lattices_[0].active.size());
  bool has_walls = walls_ != nullptr;
  archive(has_walls);
  if (!has_walls) return;
  if (archive.restores()) walls_ = std::make_unique<SurfaceCache<D>>(tracer, false, 1.0, 0, true);
  std::vector<Rgb>& radiance = walls_->finished();
  archive(radiance, radiance.size());
}

template <int D>
std::vector<Rgb> PhotonLight<D>::backs(const TexelLattice<D>& texels) const {
  std::vector<Average> known(backs_.size());
  parallel_each(known.size(), [&](std::size_t s) { known[s].mean = backs_[s]; });
  std::vector<Rgb> light(texels.active.size());
  parallel_each(light.size(), [&](std::size_t s) {
    light[s] = interpolated(lattices_[0], known, texels, s).mean;
  });
  return light;
}

template class PhotonLight<2>;
template class PhotonLight<3>;

}  // namespace leaflight
