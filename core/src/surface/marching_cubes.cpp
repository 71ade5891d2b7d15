// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/marching_cubes.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "leaflight/surface/cell_polygons.h"
#include "leaflight/surface/crossed_edges.h"

namespace leaflight {
namespace {

using Triangle = std::array<std::int32_t, 3>;

void cell_facets(const Field<3>& field, double isovalue, const CrossedEdges<3>& edges,
                 const Index<3>& cell, bool mirrored, std::vector<Triangle>& triangles) {
  CellCorners<3> corners = load_corners(field, cell);
  unsigned above = 0;
  bool masked = false;
  for (int i = 0; i < 8; ++i) {
    above |= static_cast<unsigned>(corners.h[i] >= isovalue) << i;
    masked |= std::isnan(corners.h[i]);
    corners.h[i] -= isovalue;
  }
  if (above == 0 || above == 255 || masked) return;
  const CellTriangles& found = cell_triangles(above, joined_faces(corners.h, above));
  for (int t = 0; t < found.count; ++t) {
    Triangle v;
    for (int k = 0; k < 3; ++k) {
      const CellEdge e = cell_edge(found.edge[3 * t + k]);
      Index<3> voxel;
      for (int a = 0; a < 3; ++a) voxel[a] = cell[a] + ((e.corner >> a) & 1);
      v[k] = edges.number(voxel, e.axis);
    }
    if (mirrored) std::swap(v[1], v[2]);
    triangles.push_back(v);
  }
}

}  // namespace

IsosurfaceMesh contour(const Field<3>& field, double isovalue) {
  const CrossedEdges<3> edges(field, isovalue);
  IsosurfaceMesh mesh;
  edges.place(mesh.vertices, mesh.normals);
  std::vector<std::vector<Triangle>> pieces(edges.bricks().size());
  // Outside is in front in index coordinates; a mirroring transform turns that around.
  const bool mirrored = determinant(field.index_to_world) < 0;
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t p) {
    edges.for_each_cell(edges.bricks()[p], [&](const Index<3>& cell) {
      cell_facets(field, isovalue, edges, cell, mirrored, pieces[p]);
    });
  });
  std::size_t total = 0;
  for (const auto& piece : pieces) total += piece.size();
  mesh.triangles.reserve(total);
  for (const auto& piece : pieces) {
    mesh.triangles.insert(mesh.triangles.end(), piece.begin(), piece.end());
  }
  if (field.masked) drop_unused_vertices(mesh.vertices, mesh.normals, mesh.triangles);
  return mesh;
}

}  // namespace leaflight
