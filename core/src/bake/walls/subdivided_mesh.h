// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.h"
#include "trace/scene_tracer.h"
#include "transport/reference.h"

namespace leaflight {

// A mesh of the walls cut finely enough to show light at its vertices.
template <int D>
struct FineMesh {
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<typename Mesh<D>::Facet> facets;
  std::vector<FacetPoint> places;  // of the vertices, a little within a facet that holds them
  // Of the vertices, unit. Where facets meet at a few degrees they turn evenly from the one to the
  // other, and so does light on a curved wall.
  std::vector<Vec<D>> normals;
};

// The same mesh cut twice: indirect light, which is smooth, is known at the vertices of the one,
// direct light with its shadows at those of the other, whose edges are half as long.
template <int D>
struct SubdividedMesh {
  FineMesh<D> coarse, fine;
  // Of each fine vertex the two coarse ones that it lies halfway between; the same one twice where
  // it lies on it.
  std::vector<std::array<std::uint32_t, 2>> between;
};

// Finest near the volumes (wall_spacing.h). A pure function of the scene, so that a file needs to
// hold light alone.
template <int D>
std::vector<SubdividedMesh<D>> subdivide(const Scene<D>& scene);

// The meshes of a scene, cut as those of an earlier one with the same facets were, wherever they
// are now: their vertices then correspond. `same_as`: of each mesh its number in the earlier scene;
// -1: it is new.
template <int D>
std::vector<SubdividedMesh<D>> subdivide_as(const Scene<D>& earlier, const Scene<D>& scene,
                                            const std::vector<int>& same_as);

// A vertex of a mesh as a point that receives light, on the front or on the back.
template <int D>
SurfacePoint<D> vertex_point(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                             std::size_t vertex, bool front, double c);

}  // namespace leaflight
