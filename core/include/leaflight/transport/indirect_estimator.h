// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "leaflight/transport/leaf_cache.h"
#include "leaflight/transport/surface_cache.h"

namespace leaflight {

// Answers "which radiance does this point reflect of light that has bounced before?" with one
// sample.
class IndirectEstimator {
 public:
  virtual ~IndirectEstimator() = default;
  // `u` uniform in [0,1)^2 and well distributed over the samples of one texel or point; `random`
  // for all further choices. Adds the rays traced to `rays`.
  virtual Rgb indirect_radiance(const SurfacePoint& point, const std::array<double, 2>& u,
                                Random& random, std::uint64_t& rays) const = 0;
};

// Unbiased: follows the path until Russian roulette ends it, with a shadow ray at each bounce.
std::unique_ptr<IndirectEstimator> make_path_estimator(const SceneTracer& tracer,
                                                       const LightSampler& lights);

// The photons' density at the point (Eq. E(R) of LeafCache): no rays at all.
std::unique_ptr<IndirectEstimator> make_volumetric_estimator(const LeafCache& leaves,
                                                             const TexelLattice& lattice);

// One final-gather ray that looks up what it meets: a ray of leaf c meets only points y with
// h(y) = c, so the texture being baked is its own radiance cache. `outer_direct` is the direct
// radiance of each active texel.
std::unique_ptr<IndirectEstimator> make_gather_estimator(const SceneTracer& tracer,
                                                         const LeafCache& leaves,
                                                         const SurfaceCache& surroundings,
                                                         const TexelLattice& lattice,
                                                         const std::vector<Rgb>& outer_direct);

}  // namespace leaflight
