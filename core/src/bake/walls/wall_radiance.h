// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/walls/mesh_direct_light.h"
#include "scene/isovalue_nodes.h"

namespace leaflight {

// The radiance of the walls [W/(m^2 sr)] without the direct light of points. It is stored at the
// vertices of the coarse meshes and at nodes of the common isovalue.
template <int D>
struct WallRadiance {
  IsovalueNodes nodes;
  std::vector<SubdividedMesh<D>> meshes;
  // By mesh and side; the index is node * vertices + vertex. A side that is dark for all c is
  // empty.
  std::vector<std::array<std::vector<Vec<3, float>>, 2>> radiance;
  // Direct light of light points, for all isovalues.
  std::shared_ptr<const MeshDirectLight<D>> direct;

  bool empty() const { return radiance.empty(); }
};

// Returns the radiance at the fine vertices of a mesh.
template <int D>
std::vector<Vec<3, float>> radiance_at(const WallRadiance<D>& walls, int mesh, double c, bool back);

// Returns the walls with other strengths of the scene's lights. Direct light has one factor per
// channel for each light. Other light, except the meshes' own emission, has the factor `indirect`.
template <int D>
WallRadiance<D> relit(const WallRadiance<D>& walls, const std::vector<Mesh<D>>& meshes,
                      const std::vector<Rgb>& lights, const Vec<3, float>& indirect);

// Returns the walls of a scene whose lights, volumes and meshes may have moved. Direct light of
// points is exact. Other light, except the meshes' own emission, is scaled by `indirect`. New
// meshes have only direct light. `earlier`: the baked scene. `same_as`: see subdivide_as().
// `share`: see MeshDirectLight. `lights_alone`: true if only lights have moved, which is faster.
// Throws Cancelled.
template <int D>
WallRadiance<D> moved(const WallRadiance<D>& walls, const Scene<D>& earlier, const Scene<D>& scene,
                      const std::vector<int>& same_as, const Vec<3, float>& indirect,
                      Progress& progress, std::size_t share = 1, bool lights_alone = false);

// Connects a radiance from a file to its scene and computes its direct light. Throws Error if the
// walls differ, or Cancelled.
template <int D>
void attach(WallRadiance<D>& radiance, const Scene<D>& scene, Progress& progress);

}  // namespace leaflight
