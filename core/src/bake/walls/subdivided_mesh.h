// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.h"
#include "trace/scene_tracer.h"
#include "transport/reference.h"

namespace leaflight {

// A mesh of the walls that is fine enough to show light at its vertices.
template <int D>
struct FineMesh {
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<typename Mesh<D>::Facet> facets;
  std::vector<FacetPoint> places;  // of the vertices, slightly inside an adjacent facet
  // Unit normals of the vertices. They vary smoothly across facets that meet at small angles, so
  // light on curved walls is smooth.
  std::vector<Vec<D>> normals;
};

// A mesh at two levels of subdivision. The coarse vertices hold indirect light, which is smooth.
// The fine ones, with edges half as long, hold direct light with its shadows.
template <int D>
struct SubdividedMesh {
  FineMesh<D> coarse, fine;
  // For each fine vertex, the two coarse ones that it lies halfway between; twice the same if it is
  // a coarse vertex.
  std::vector<std::array<std::uint32_t, 2>> between;
};

// Subdivides all meshes, finest near the volumes (wall_spacing.h). It is a pure function of the
// scene, so that a file needs to store light only.
template <int D>
std::vector<SubdividedMesh<D>> subdivide(const Scene<D>& scene);

// Subdivides the meshes of a scene like those of an earlier scene with the same facets, even if
// they have moved. Their vertices then correspond. `same_as`: each mesh's number in the earlier
// scene; -1: it is new.
template <int D>
std::vector<SubdividedMesh<D>> subdivide_as(const Scene<D>& earlier, const Scene<D>& scene,
                                            const std::vector<int>& same_as);

// Returns a vertex of a mesh as a point that receives light on the front or the back.
template <int D>
SurfacePoint<D> vertex_point(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                             std::size_t vertex, bool front, double c);

}  // namespace leaflight
