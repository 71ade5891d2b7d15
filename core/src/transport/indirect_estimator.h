// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "transport/isosurface_cache.h"
#include "transport/surface_cache.h"

namespace leaflight {

// A texel of a side of a volume's isosurfaces.
template <int D>
struct IsosurfaceTexel {
  int volume;
  bool back;
  Vec<D> centre;  // index position
  Rgb albedo;
};

// Answers "which radiance does this point, of an isosurface or of the walls, reflect of light that
// has bounced diffusely before?" with one sample; in the terms of thesis Eq. 1.5 indirect indirect
// light, which mirrors and glass may have passed on. Caustics are not part of it, save where the
// estimator says so.
template <int D>
class IndirectEstimator {
 public:
  virtual ~IndirectEstimator() = default;
  // `u` uniform in [0,1)^2 and well distributed over the samples of one texel or point; `random`
  // for all further choices. Adds the rays traced to `rays`.
  virtual Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>& u,
                                Random& random, std::uint64_t& rays) const = 0;
  // Whether samples of one point differ.
  virtual bool is_random() const { return true; }
  // The variance that all samples of a texel have in common, and so do not show: that of the
  // photons' density, of the mean over the colours. `radiance`: what was found in all.
  virtual float shared_variance(const IsosurfaceTexel<D>&, const Rgb& /*radiance*/) const {
    return 0;
  }
};

// What is known of each volume's isosurfaces when photons are traced; `photons` may be null for
// isosurfaces that nothing looks up.
template <int D>
struct IsosurfaceRadiance {
  const TexelLattice<D>* lattice = nullptr;
  const IsosurfaceCache<D>* photons = nullptr;
  // Direct radiance of the active texels, front and back; empty where photons hold it.
  std::array<std::vector<Rgb>, 2> direct{};
  // All radiance of them, where it is known already: photons are not looked at then.
  std::array<std::vector<Rgb>, 2> radiance{};
};

// Photons that came by mirrors and glass, which estimators look up at points.
template <int D>
struct CausticPhotons {
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces;
  const SurfaceCache<D>* walls;  // null: no point lies on them
};

// Unbiased: follows the path until Russian roulette ends it, with a shadow ray at each diffuse
// bounce. Without photons, caustics are included, since a path may hit a light by way of mirrors
// and glass; not those of lights without extent, which no path can hit. With them, photons light
// all diffuse surfaces after the first.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_path_estimator(
    const SceneTracer<D>& tracer, const LightSampler<D>& lights,
    const CausticPhotons<D>* photons = nullptr);

// The albedo of the isosurface through an index position; of any isosurface where there is none.
template <int D>
Rgb albedo_near(const Volume<D>& volume, const Vec<D>& index_position);

// The photons' density at the point (Eq. E(R) of IsosurfaceCache): no rays at all. `walls` may be
// null if no point lies on them.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_volumetric_estimator(
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>* walls);

// One final-gather ray that looks up stored light where it hits: a ray of isosurface c hits only
// points y with h(y) = c, so the texture being baked is its own radiance cache.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_gather_estimator(
    const SceneTracer<D>& tracer, const LightSampler<D>& lights,
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>& walls);

// What a point reflects of caustics, from the photons' density. `walls` may be null if the
// point does not lie on them.
template <int D>
Rgb caustic_radiance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                     const SurfaceCache<D>* walls, const SurfacePoint<D>& point);

// The variance that all caustics of a texel have in common.
template <int D>
float caustic_variance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                       const IsosurfaceTexel<D>& texel);

}  // namespace leaflight
