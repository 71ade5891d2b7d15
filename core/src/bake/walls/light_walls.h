// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/point_sampler.h"
#include "bake/walls/wall_radiance.h"
#include "base/progress.h"

namespace leaflight {

// Computes the radiance of both sides of the diffuse walls (wall_light.h). `samples`: per vertex
// and node. The estimator is null if there is no indirect light. `meshes` and `direct`: of the same
// scene.
template <int D>
WallRadiance<D> light_walls(const SceneTracer<D>& tracer, const PointSampler<D>& sampler,
                            const IndirectEstimator<D>* estimator,
                            const std::vector<SubdividedMesh<D>>& meshes,
                            std::shared_ptr<const MeshDirectLight<D>> direct, int samples,
                            std::uint64_t seed, Progress& progress);

}  // namespace leaflight
