// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/photon_caches.h"

#include <algorithm>

#include "base/parallel.h"
#include "transport/photon_tracer.h"

namespace leaflight {
namespace {

constexpr std::size_t photons_per_piece = 4096;

// Returns the largest flux-height with which a photon starts (thesis Eq. 4.4).
template <int D>
double largest_photon_flux(const LightSampler<D>& lights, const PhotonSettings& settings,
                           const Plan& plan) {
  std::uint64_t fewest = plan.photons ? settings.photons : settings.caustic_photons;
  if (plan.caustics) fewest = std::min(fewest, settings.caustic_photons);
  return lights.largest_flux_height() / static_cast<double>(fewest);
}

}  // namespace

template <int D>
PhotonCaches<D> trace_into_caches(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                                  const std::vector<TexelLattice<D>>& lattices,
                                  const PhotonSettings& settings, const Plan& plan,
                                  Progress& progress) {
  const bool lights_walls = settings.wall_samples > 0;
  const std::uint64_t photons =
      (plan.photons ? settings.photons : 0) + (plan.caustics ? settings.caustic_photons : 0);
  const double photon_flux = largest_photon_flux(lights, settings, plan);
  const SideContents back = plan.back        ? SideContents::indirect
                            : plan.back_side ? SideContents::all
                                             : SideContents::nothing;
  PhotonCaches<D> caches;
  for (std::size_t v = 0; v < lattices.size(); ++v) {
    caches.isosurfaces.push_back(std::make_unique<IsosurfaceCache<D>>(
        tracer, static_cast<int>(v), lattices[v], back, settings.variance, plan.caustics,
        photon_flux, photons));
  }
  if (plan.wall_cache || lights_walls) {
    caches.walls = std::make_unique<SurfaceCache<D>>(tracer, plan.caustics, photon_flux, photons,
                                                     settings.smooth_walls);
  }
  const auto trace = [&](PhotonPaths paths, std::uint64_t count) {
    const auto store = [&](const PhotonHit<D>& photon) {
      // Caustic photons carry this light.
      const bool caustic = photon.arrival == Arrival::caustic;
      if (paths == PhotonPaths::all && plan.caustics && caustic) return;
      if (photon.point.kind() == HitKind::isosurface) {
        caches.isosurfaces[photon.point.isosurface().volume]->deposit(photon);
      } else if (plan.wall_cache) {
        caches.walls->deposit(photon);
      }
    };
    parallel_range(count, photons_per_piece, rays_per_photon, progress,
                   [&](std::size_t begin, std::size_t end) {
                     progress.count_rays(trace_photons(tracer, lights, paths, settings.seed, begin,
                                                       end, count, store));
                   });
  };
  if (plan.photons) {
    progress.begin("Tracing photons");
    trace(PhotonPaths::all, settings.photons);
  }
  if (plan.caustics) {
    progress.begin("Tracing caustics");
    trace(PhotonPaths::caustics, settings.caustic_photons);
  }
  for (const auto& cache : caches.isosurfaces) cache->finish(progress);
  if (!plan.wall_cache || !lights_walls) return caches;
  progress.begin("Lighting the walls");
  SurfaceCache<D>& walls = *caches.walls;
  walls.collect_photons(settings.smooth_walls, progress);
  parallel_range(walls.columns(), 64, 0, progress, [&](std::size_t begin, std::size_t end) {
    std::uint64_t traced = 0;
    for (std::size_t column = begin; column < end; ++column) {
      walls.finish(column, lights, settings.wall_samples, settings.seed, traced);
    }
    progress.count_rays(traced);
  });
  return caches;
}

template PhotonCaches<2> trace_into_caches(const SceneTracer<2>&, const LightSampler<2>&,
                                           const std::vector<TexelLattice<2>>&,
                                           const PhotonSettings&, const Plan&, Progress&);
template PhotonCaches<3> trace_into_caches(const SceneTracer<3>&, const LightSampler<3>&,
                                           const std::vector<TexelLattice<3>>&,
                                           const PhotonSettings&, const Plan&, Progress&);

}  // namespace leaflight
