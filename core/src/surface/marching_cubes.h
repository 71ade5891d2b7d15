// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "surface/crossed_edges.h"

namespace leaflight {

// The mesh of an isosurface. Vertices lie on the edges of the grid, except for the last few, which
// are inside cells. Normals are those of the shading gradient, outward, towards lower values.
// Triangles are counter-clockwise seen from outside.
struct IsosurfaceMesh {
  std::vector<Vec<3, float>> vertices;  // world
  std::vector<Vec<3, float>> normals;   // world, unit; zero where the gradient vanishes
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// Marching cubes (Lorensen and Cline 1987) with the topology of the trilinear interpolant
// (Chernyaev 1995). It visits only bricks whose interval contains the isovalue. The mesh is a
// manifold without cracks. Each side of a triangle belongs to two triangles, or to one at the
// border of the domain or of a masked cell. The result does not depend on the number of threads.
class MarchingCubes {
 public:
  // Counts vertices and triangles. `field` must outlive this. Throws Error if there are more than
  // 2^31 of either.
  MarchingCubes(const Field<3>& field, double isovalue);

  std::size_t vertices() const { return vertices_; }
  std::size_t triangles() const { return triangles_; }

  // A callback for vertices when they are known, from several threads. It receives the number of
  // the first and their index positions.
  using Visit = std::function<void(std::size_t, const std::vector<Vec3>&)>;

  // Fills in vertices, triangles, and normals if requested. Reuses the mesh's memory.
  void fill(IsosurfaceMesh& mesh, bool normals, const Visit& visit = nullptr) const;

 private:
  struct BrickFacets {
    int triangles = 0, inside = 0;  // inside: vertices inside cells
    std::int64_t first_triangle = 0, first_inside = 0;
  };

  CrossedEdges<3> edges_;
  std::vector<BrickFacets> bricks_;  // in the order of edges_.bricks()
  std::size_t vertices_ = 0, triangles_ = 0;
};

// Removes vertices without a triangle, which are on edges between masked cells.
void drop_unused_vertices(IsosurfaceMesh& mesh);

// Contours a field without unused vertices, with normals if requested. Reuses the mesh's memory.
void contour(const Field<3>& field, double isovalue, bool normals, IsosurfaceMesh& mesh);

// Returns a contour with normals.
IsosurfaceMesh contour(const Field<3>& field, double isovalue);

}  // namespace leaflight
