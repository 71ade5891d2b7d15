// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/point_sampler.h"
#include "bake/walls/wall_radiance.h"
#include "math/progress.h"

namespace leaflight {

// Vertices of the walls are fewer and farther apart than texels, and take more samples: so
// many times a texel's.
inline constexpr int walls_share = 2;

// The radiance of both sides of the diffuse walls (wall_light.h) by so many samples per
// vertex and node. The estimator may be null where there is no indirect light. `meshes` and
// `direct`: of the same scene.
template <int D>
WallRadiance<D> light_walls(const SceneTracer<D>& tracer, const PointSampler<D>& sampler,
                            const IndirectEstimator<D>* estimator,
                            const std::vector<SubdividedMesh<D>>& meshes,
                            std::shared_ptr<const MeshDirectLight<D>> direct, int samples,
                            std::uint64_t seed, Progress& progress);

}  // namespace leaflight
