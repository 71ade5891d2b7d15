// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/wall_radiance.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace leaflight {

template <int D>
std::vector<Vec<3, float>> radiance_at(const WallRadiance<D>& walls, int mesh, double c,
                                       bool back) {
  const SubdividedMesh<D>& subdivided = walls.meshes[mesh];
  std::vector<Vec<3, float>> radiance = walls.direct->radiance(mesh, c, back);
  radiance.resize(subdivided.fine.vertices.size(), Vec<3, float>(0));
  const auto& values = walls.radiance[mesh][back];
  if (values.empty()) return radiance;
  const std::size_t n = subdivided.coarse.vertices.size();
  const IsovalueNodes::Place at = walls.nodes.place(c);
  const Vec<3, float>*low = &values[at.low * n], *high = low + n;
  const float t = 0.5f * static_cast<float>(at.t), rest = 0.5f - t;
  parallel_each(radiance.size(), [&](std::size_t v) {
    const auto [a, b] = subdivided.between[v];
    radiance[v] += (low[a] + low[b]) * rest + (high[a] + high[b]) * t;
  });
  return radiance;
}

namespace {

// Scales all light except the mesh's own emission.
template <int D>
void scale(std::array<std::vector<Vec<3, float>>, 2>& sides, const Mesh<D>& mesh,
           const Vec<3, float>& factor) {
  const Vec<3, float> emission(mesh.emission);
  for (auto& side : sides) {
    for (Vec<3, float>& light : side) {
      light = emission + (light - emission) * factor;
      for (int i = 0; i < 3; ++i) light[i] = std::max(0.0f, light[i]);
    }
  }
}

}  // namespace

template <int D>
WallRadiance<D> relit(const WallRadiance<D>& walls, const std::vector<Mesh<D>>& meshes,
                      const std::vector<Rgb>& lights, const Vec<3, float>& indirect) {
  WallRadiance<D> result = walls;
  for (std::size_t m = 0; m < meshes.size(); ++m) scale(result.radiance[m], meshes[m], indirect);
  result.direct = std::make_shared<const MeshDirectLight<D>>(walls.direct->scaled(lights));
  return result;
}

template <int D>
WallRadiance<D> moved(const WallRadiance<D>& walls, const Scene<D>& earlier, const Scene<D>& scene,
                      const std::vector<int>& same_as, const Vec<3, float>& indirect,
                      Progress& progress, std::size_t share, bool lights_alone) {
  WallRadiance<D> result{walls.nodes, subdivide_as(earlier, scene, same_as), {}, nullptr};
  result.radiance.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (same_as[m] < 0) continue;
    const std::size_t vertices = result.meshes[m].coarse.vertices.size();
    if (vertices != walls.meshes.at(same_as[m]).coarse.vertices.size()) continue;
    result.radiance[m] = walls.radiance[same_as[m]];
    scale(result.radiance[m], earlier.meshes[same_as[m]], indirect);
  }
  const SceneTracer<D> tracer(scene);
  result.direct = std::make_shared<const MeshDirectLight<D>>(
      tracer, result.meshes, progress, share, lights_alone ? walls.direct.get() : nullptr);
  return result;
}

template <int D>
void attach(WallRadiance<D>& radiance, const Scene<D>& scene, Progress& progress) {
  radiance.meshes = subdivide(scene);
  radiance.nodes = IsovalueNodes(scene);
  bool fits = radiance.meshes.size() == radiance.radiance.size();
  for (std::size_t m = 0; fits && m < scene.meshes.size(); ++m) {
    const std::size_t entries = radiance.meshes[m].coarse.vertices.size() * IsovalueNodes::count;
    for (const auto& side : radiance.radiance[m]) {
      fits = fits && (side.empty() || side.size() == entries);
    }
  }
  if (!fits) {
    throw Error(
        "The radiance of the walls does not belong to the meshes of its scene; bake again.");
  }
  const SceneTracer<D> tracer(scene);
  progress.expect_more(work_of_shadow_rays(tracer, radiance.meshes));
  radiance.direct = std::make_shared<const MeshDirectLight<D>>(tracer, radiance.meshes, progress);
}

template WallRadiance<2> relit(const WallRadiance<2>&, const std::vector<Mesh<2>>&,
                               const std::vector<Rgb>&, const Vec<3, float>&);
template WallRadiance<3> relit(const WallRadiance<3>&, const std::vector<Mesh<3>>&,
                               const std::vector<Rgb>&, const Vec<3, float>&);
template WallRadiance<2> moved(const WallRadiance<2>&, const Scene<2>&, const Scene<2>&,
                               const std::vector<int>&, const Vec<3, float>&, Progress&,
                               std::size_t, bool);
template WallRadiance<3> moved(const WallRadiance<3>&, const Scene<3>&, const Scene<3>&,
                               const std::vector<int>&, const Vec<3, float>&, Progress&,
                               std::size_t, bool);
template void attach<2>(WallRadiance<2>&, const Scene<2>&, Progress&);
template void attach<3>(WallRadiance<3>&, const Scene<3>&, Progress&);
template std::vector<Vec<3, float>> radiance_at<2>(const WallRadiance<2>&, int, double, bool);
template std::vector<Vec<3, float>> radiance_at<3>(const WallRadiance<3>&, int, double, bool);

}  // namespace leaflight
