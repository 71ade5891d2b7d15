// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/light_walls.h"

#include <algorithm>

#include "bake/walls/wall_light.h"

namespace leaflight {

template <int D>
WallRadiance<D> light_walls(const SceneTracer<D>& tracer, const PointSampler<D>& sampler,
                            const IndirectEstimator<D>* estimator,
                            const std::vector<SubdividedMesh<D>>& meshes,
                            std::shared_ptr<const MeshDirectLight<D>> direct, int samples,
                            std::uint64_t seed, Progress& progress) {
  const SplitLight<D> split = split_light(tracer);  // the sampler refers to it
  const LightSampler<D> wide(tracer, split);
  const PointSampler<D> but_points{wide, sampler.isosurfaces, sampler.walls, sampler.caustics};
  WallLight<D> walls(tracer, meshes);
  const int half = std::max(1, samples / 2);
  for (int i = 0; i < 2; ++i) walls.add(but_points, estimator, {seed, half}, progress);
  return walls.radiance(std::move(direct), progress);
}

template WallRadiance<2> light_walls(const SceneTracer<2>&, const PointSampler<2>&,
                                     const IndirectEstimator<2>*,
                                     const std::vector<SubdividedMesh<2>>&,
                                     std::shared_ptr<const MeshDirectLight<2>>, int, std::uint64_t,
                                     Progress&);
template WallRadiance<3> light_walls(const SceneTracer<3>&, const PointSampler<3>&,
                                     const IndirectEstimator<3>*,
                                     const std::vector<SubdividedMesh<3>>&,
                                     std::shared_ptr<const MeshDirectLight<3>>, int, std::uint64_t,
                                     Progress&);

}  // namespace leaflight
