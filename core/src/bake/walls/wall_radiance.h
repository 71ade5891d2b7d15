// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/walls/mesh_direct_light.h"
#include "scene/isovalue_nodes.h"

namespace leaflight {

// Walls are prisms over (u, v, c): their radiance [W/(m^2 sr)], all but the direct light of points,
// at the vertices of the coarse meshes and at nodes of the common isovalue.
template <int D>
struct WallRadiance {
  IsovalueNodes nodes;
  std::vector<SubdividedMesh<D>> meshes;
  // Per mesh; [front or back][node * vertices + vertex], a side that is dark for all c is empty.
  std::vector<std::array<std::vector<Vec<3, float>>, 2>> radiance;
  std::shared_ptr<const MeshDirectLight<D>> direct;  // of points, for all c

  bool empty() const { return radiance.empty(); }
};

// All radiance at the fine vertices of a mesh.
template <int D>
std::vector<Vec<3, float>> radiance_at(const WallRadiance<D>& walls, int mesh, double c, bool back);

// The same with other strengths of the scene's lights: direct light by a factor per channel for
// each, all else but the meshes' own emission by one.
template <int D>
WallRadiance<D> relit(const WallRadiance<D>& walls, const std::vector<Mesh<D>>& meshes,
                      const std::vector<Rgb>& lights, const Vec<3, float>& indirect);

// The same beside another scene, where lights, volumes and meshes may have moved: the direct light
// of points is exact, all else but the meshes' own emission is scaled by a factor. `earlier`: the
// scene that was baked. `same_as`: as subdivide_as() has it; a new mesh has direct light alone.
// `share`: as MeshDirectLight has it; `lights_alone`: whether only lights have moved, which takes
// less time. Throws Cancelled.
template <int D>
WallRadiance<D> moved(const WallRadiance<D>& walls, const Scene<D>& earlier, const Scene<D>& scene,
                      const std::vector<int>& same_as, const Vec<3, float>& indirect,
                      Progress& progress, std::size_t share = 1, bool lights_alone = false);

// Gives a radiance that was read from a file the scene it belongs to, and its direct light. Throws
// Error if its walls are others, Cancelled.
template <int D>
void attach(WallRadiance<D>& radiance, const Scene<D>& scene, Progress& progress);

}  // namespace leaflight
