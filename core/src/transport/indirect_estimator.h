// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "transport/isosurface_cache.h"
#include "transport/surface_cache.h"

namespace leaflight {

// A one-sample estimator of the radiance that a point reflects of indirect light. The point is on
// an isosurface or a wall. Indirect light has bounced diffusely before, and may have passed mirrors
// and glass. It is the indirect part of thesis Eq. 1.5. Caustics are excluded unless the estimator
// says otherwise.
template <int D>
class IndirectEstimator {
 public:
  virtual ~IndirectEstimator() = default;
  // Estimates the radiance. `u`: uniform in [0,1)^2, well distributed over the samples of one texel
  // or point. `random`: for all further choices. Adds the traced rays to `rays`.
  virtual Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>& u,
                                Random& random, std::uint64_t& rays) const = 0;
};

// The light of each volume's isosurfaces after photon tracing. `photons` is null if nothing looks
// them up.
template <int D>
struct IsosurfaceRadiance {
  const TexelLattice<D>* lattice = nullptr;
  const IsosurfaceCache<D>* photons = nullptr;
  // All radiance of the active texels, front and back, for gather rays.
  std::array<std::vector<Rgb>, 2> radiance{};
};

// Photons that arrived by mirrors and glass, for lookups at points.
template <int D>
struct CausticPhotons {
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces;
  const SurfaceCache<D>* walls;  // null: no point is on a wall
};

// Makes the unbiased path estimator. Paths end by Russian roulette, with a shadow ray at each
// diffuse bounce. Without photons, paths include caustics, except those of lights without extent,
// which no path can hit. With photons, photons carry caustics on all diffuse surfaces after the
// first.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_path_estimator(
    const SceneTracer<D>& tracer, const LightSampler<D>& lights,
    const CausticPhotons<D>* photons = nullptr);

// Makes an estimator with one final-gather ray, which looks up stored light at its hit. A ray of
// isosurface c hits only points y with h(y) = c. So the baked texture is its own radiance cache.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_gather_estimator(
    const SceneTracer<D>& tracer, const LightSampler<D>& lights,
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>& walls);

// Returns the caustics that a point reflects, from the photon density. `walls` is null if the point
// is not on a wall.
template <int D>
Rgb caustic_radiance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                     const SurfaceCache<D>* walls, const SurfacePoint<D>& point);

}  // namespace leaflight
