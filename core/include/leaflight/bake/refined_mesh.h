// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/scene/scene.h"
#include "leaflight/transport/reference.h"

namespace leaflight {

// A mesh of the surroundings cut finely enough to show light at its vertices.
template <int D>
struct FineMesh {
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<typename Mesh<D>::Facet> facets;
  std::vector<FacetPoint> places;  // of the vertices, a little within a facet that holds them
  std::vector<std::array<int, 2>> numbers;  // of the vertices, counted along the facet's edges
};

// The same mesh cut twice: indirect light, which is smooth, is known at the vertices of the one,
// direct light with its shadows at those of the other, whose edges are half as long.
template <int D>
struct RefinedMesh {
  FineMesh<D> coarse, fine;
  // Of each fine vertex the two coarse ones that it lies halfway between; the same one twice where
  // it lies on it.
  std::vector<std::array<std::uint32_t, 2>> between;
};

// A pure function of the meshes, so that a file needs to hold light alone.
template <int D>
std::vector<RefinedMesh<D>> refine(const std::vector<Mesh<D>>& meshes);

}  // namespace leaflight
