// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "leaflight/bake/point_sampler.h"
#include "leaflight/bake/surroundings_radiance.h"
#include "leaflight/math/progress.h"

namespace leaflight {

// Vertices of the surroundings are fewer and farther apart than texels, and take more samples: so
// many times a texel's.
inline constexpr int surroundings_share = 2;

template <int D>
struct SurroundingsWork {
  std::vector<RefinedMesh<D>> meshes;
  int samples;             // per vertex and node
  double rays_per_sample;  // expected
  std::uint64_t seed;
};

// The radiance of both sides of the diffuse surroundings: the direct light of points for all c, all
// else at every node of c. The estimator may be null where there is no soft light. Adds the rays
// traced to `rays`.
template <int D>
SurroundingsRadiance<D> light_surroundings(const SceneTracer<D>& tracer,
                                           const PointSampler<D>& sampler,
                                           const IndirectEstimator<D>* estimator,
                                           SurroundingsWork<D> work, Progress& progress,
                                           std::atomic<std::uint64_t>& rays);

}  // namespace leaflight
