// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "surface/crossed_edges.h"

namespace leaflight {

// Vertices lie on the edges of the grid, and last a few inside cells; normals are those of the
// shading gradient, outward, towards lower values. Triangles are counter-clockwise seen from
// outside.
struct IsosurfaceMesh {
  std::vector<Vec<3, float>> vertices;  // world
  std::vector<Vec<3, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// Marching cubes (Lorensen and Cline 1987) that visits only the bricks whose interval holds the
// isovalue, with the topology of the trilinear interpolant (Chernyaev 1995). The mesh is a
// manifold: without cracks, and each side of a triangle belongs to two of them, or to one where the
// isosurface meets the border of the domain or a masked cell. The result does not depend on the
// number of threads.
class MarchingCubes {
 public:
  // Counts. `field` must outlive this. Throws Error when there are more than 2^31 vertices or
  // triangles.
  MarchingCubes(const Field<3>& field, double isovalue);

  std::size_t vertices() const { return vertices_; }
  std::size_t triangles() const { return triangles_; }

  // What is done with some vertices as soon as they are known, by several threads at once: the
  // number of the first, and where they lie (index positions).
  using Visit = std::function<void(std::size_t, const std::vector<Vec3>&)>;

  // Vertices, triangles, and normals if wished. Uses the mesh's memory again.
  void fill(IsosurfaceMesh& mesh, bool normals, const Visit& visit = nullptr) const;

 private:
  struct BrickFacets {
    int triangles = 0, inside = 0;  // inside: vertices inside cells
    std::int64_t first_triangle = 0, first_inside = 0;
  };

  CrossedEdges<3> edges_;
  std::vector<BrickFacets> bricks_;  // as edges_.bricks()
  std::size_t vertices_ = 0, triangles_ = 0;
};

// Removes the vertices that no triangle has: those of edges between masked cells.
void drop_unused_vertices(IsosurfaceMesh& mesh);

// The mesh without unused vertices; with normals if wished. Uses the mesh's memory again.
void contour(const Field<3>& field, double isovalue, bool normals, IsosurfaceMesh& mesh);

// The same, with normals.
IsosurfaceMesh contour(const Field<3>& field, double isovalue);

}  // namespace leaflight
