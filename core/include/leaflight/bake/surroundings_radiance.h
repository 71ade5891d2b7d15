// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/scene/leaf_nodes.h"
#include "leaflight/transport/reference.h"

namespace leaflight {

// The surroundings cut finely enough to show light and shadow at their vertices. A pure function of
// the meshes, so that a file needs to hold the radiance alone.
template <int D>
struct FineMesh {
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<typename Mesh<D>::Facet> facets;
  std::vector<FacetPoint> places;  // of the vertices, a little within a facet that holds them
};
template <int D>
std::vector<FineMesh<D>> refine(const std::vector<Mesh<D>>& meshes);

// Walls are prisms over (u, v, c): their radiance [W/(m^2 sr)] at the vertices of the fine meshes
// and at nodes of the leaf coordinate.
template <int D>
struct SurroundingsRadiance {
  LeafNodes nodes;
  std::vector<FineMesh<D>> meshes;
  // Per mesh; [front or back][node * vertices + vertex], a side that is dark for all c is empty.
  std::vector<std::array<std::vector<Vec<3, float>>, 2>> radiance;

  bool empty() const { return radiance.empty(); }
};

// Radiance at the vertices of a mesh, linear between the nodes; zeros for a dark side.
template <int D>
std::vector<Vec<3, float>> radiance_at(const SurroundingsRadiance<D>& surroundings, int mesh,
                                       double c, bool back);

// Gives a radiance that was read from a file the scene it belongs to. Throws Error if its
// surroundings are others.
template <int D>
void attach(SurroundingsRadiance<D>& radiance, const Scene<D>& scene);

}  // namespace leaflight
