// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "leaflight/transport/leaf_cache.h"
#include "leaflight/transport/surface_cache.h"

namespace leaflight {

// Answers "which radiance does this point reflect of light that has bounced before?" with one
// sample.
template <int D>
class IndirectEstimator {
 public:
  virtual ~IndirectEstimator() = default;
  // `u` uniform in [0,1)^2 and well distributed over the samples of one texel or point; `random`
  // for all further choices. Adds the rays traced to `rays`.
  virtual Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>& u,
                                Random& random, std::uint64_t& rays) const = 0;
};

// Unbiased: follows the path until Russian roulette ends it, with a shadow ray at each bounce.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_path_estimator(const SceneTracer<D>& tracer,
                                                          const LightSampler<D>& lights);

// The photons' density at the point (Eq. E(R) of LeafCache): no rays at all.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_volumetric_estimator(const LeafCache<D>& leaves,
                                                                const TexelLattice<D>& lattice);

// One final-gather ray that looks up what it meets: a ray of leaf c meets only points y with
// h(y) = c, so the texture being baked is its own radiance cache. `outer_direct` is the direct
// radiance of each active texel.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_gather_estimator(const SceneTracer<D>& tracer,
                                                            const LeafCache<D>& leaves,
                                                            const SurfaceCache<D>& surroundings,
                                                            const TexelLattice<D>& lattice,
                                                            const std::vector<Rgb>& outer_direct);

}  // namespace leaflight
