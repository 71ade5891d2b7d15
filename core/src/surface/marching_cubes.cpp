// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/marching_cubes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <string>

#include "base/error.h"
#include "base/release.h"
#include "field/shading_gradient.h"
#include "surface/cell_polygons.h"
#include "surface/cell_triangles.h"
#include "surface/points_inside.h"

namespace leaflight {
namespace {

using Triangle = std::array<std::int32_t, 3>;
using Values = BrickValues<3>;
using BrickEdges = CrossedEdges<3>::BrickEdges;

constexpr int places = Values::width * Values::width * Values::width;

// Returns h - c at the corners of the cell with this bit.
std::array<double, 8> corners_of(const Values& values, int bit, double isovalue) {
  std::array<double, 8> g;
  for (int corner = 0; corner < 8; ++corner) {
    int place = Values::place(bit);
    for (int a = 0; a < 3; ++a) place += ((corner >> a) & 1) * Values::stride(a);
    g[corner] = values.h[place] - isovalue;
  }
  return g;
}

// Returns the triangles of a cell that the isosurface crosses.
const CellTriangles& triangles_of(const std::array<CellTriangles, 256>& plain, const Values& values,
                                  int bit, double isovalue) {
  const unsigned above = values.corners_above(bit);
  const CellTriangles& triangles = plain[above];
  return triangles.count > 0 ? triangles
                             : ambiguous_triangles(above, corners_of(values, bit, isovalue));
}

// Returns the offsets in VertexNumbers from a cell's first edge to its edges.
std::array<int, 12> edge_offsets() {
  std::array<int, 12> offset;
  for (int edge = 0; edge < 12; ++edge) {
    const auto [axis, corner] = cell_edge(edge);
    offset[edge] = axis * places;
    for (int a = 0; a < 3; ++a) offset[edge] += ((corner >> a) & 1) * Values::stride(a);
  }
  return offset;
}

// The numbers of the vertices on a brick's edges, by axis and place of the edge's lower voxel.
class VertexNumbers {
 public:
  VertexNumbers(const CrossedEdges<3>& edges, const BrickEdges& brick) {
    for (int beside = 0; beside < 8; ++beside) {
      if (const BrickEdges* other = edges.beside(brick, beside)) take(*other, beside);
    }
  }
  std::int32_t at(int place) const { return number_[place]; }

 private:
  // Copies the numbers that the brick shares with the brick behind its upper faces along these
  // axes.
  void take(const BrickEdges& other, int beside) {
    constexpr std::array<std::uint64_t, 3> first_plane{0x1111111111111111, 0x000F000F000F000F,
                                                       0xFFFF};
    std::uint64_t shared = ~std::uint64_t{0};
    int shift = 0;
    for (int a = 0; a < 3; ++a) {
      if (!((beside >> a) & 1)) continue;
      shared &= first_plane[a];
      shift += Values::size * Values::stride(a);
    }
    for (int axis = 0; axis < 3; ++axis) {
      if ((beside >> axis) & 1) continue;
      std::int32_t* const numbers = &number_[axis * places + shift];
      for_each_bit(other.edges[axis] & shared, [&](int bit) {
        numbers[Values::place(bit)] = static_cast<std::int32_t>(other.number(axis, bit));
      });
    }
  }

  std::array<std::int32_t, 3 * places> number_;
};

void check_count(std::int64_t count, const char* what) {
  if (count <= std::numeric_limits<std::int32_t>::max()) return;
  throw Error("The isosurface has " + std::to_string(count) + " " + what +
              ", more than a mesh can hold; reduce the volume's resolution.");
}

// Resizes a vector and reuses its memory, without a copy of its old elements if it must grow.
template <class Element>
void resize(std::vector<Element>& list, std::size_t size) {
  if (list.capacity() < size) release(list);
  list.resize(size);
}

void place_on_edges(const CrossedEdges<3>& edges, const BrickEdges& brick, const Values& values,
                    std::vector<Vec3>& positions) {
  positions.clear();
  for (int axis = 0; axis < 3; ++axis) {
    for_each_bit(brick.edges[axis],
                 [&](int bit) { positions.push_back(edges.position(values, axis, bit)); });
  }
}

}  // namespace

MarchingCubes::MarchingCubes(const Field<3>& field, double isovalue) : edges_(field, isovalue) {
  bricks_.resize(edges_.bricks().size());
  const auto& plain = plain_triangles();
  edges_.mark([&](std::size_t i, const Values& values) {
    for_each_bit(values.crossed_cells(), [&](int bit) {
      const CellTriangles& found = triangles_of(plain, values, bit, isovalue);
      bricks_[i].triangles += found.count;
      bricks_[i].inside += found.inside;
    });
  });
  std::int64_t triangles = 0, inside = static_cast<std::int64_t>(edges_.count());
  for (BrickFacets& brick : bricks_) {
    brick.first_triangle = triangles;
    brick.first_inside = inside;
    triangles += brick.triangles;
    inside += brick.inside;
  }
  check_count(triangles, "triangles");
  check_count(inside, "vertices");
  triangles_ = static_cast<std::size_t>(triangles);
  vertices_ = static_cast<std::size_t>(inside);
}

void MarchingCubes::fill(IsosurfaceMesh& mesh, bool normals, const Visit& visit) const {
  const Field<3>& field = edges_.field();
  const double isovalue = edges_.isovalue();
  const auto& plain = plain_triangles();
  const std::array<int, 12> offset = edge_offsets();
  constexpr std::size_t grain = 64, ahead = 2;
  // The outside is in front in index coordinates; a mirroring transform reverses this.
  const bool mirrored = determinant(field.index_to_world) < 0;
  resize(mesh.vertices, vertices_);
  resize(mesh.normals, normals ? vertices_ : 0);
  resize(mesh.triangles, triangles_);
  const auto place = [&](std::int64_t first, std::vector<Vec3>& positions) {
    for (std::size_t n = 0; n < positions.size(); ++n) {
      positions[n] = flat_on_cut(field, positions[n], isovalue);
      mesh.vertices[first + n] = Vec<3, float>(field.index_to_world.point(positions[n]));
      if (normals) mesh.normals[first + n] = Vec<3, float>(shading_normal(field, positions[n]));
    }
    if (visit && !positions.empty()) visit(static_cast<std::size_t>(first), positions);
  };
  const auto fill_brick = [&](std::size_t i, std::vector<Vec3>& positions) {
    const BrickEdges& brick = edges_.bricks()[i];
    if (bricks_[i].triangles == 0 && brick.count() == 0) return;
    if (i + ahead < bricks_.size()) fetch_brick(field, edges_.bricks()[i + ahead].brick);
    const Values values = load_brick(field, brick.brick, isovalue);
    place_on_edges(edges_, brick, values, positions);
    place(brick.first, positions);
    if (bricks_[i].triangles == 0) return;
    // Fill in the triangles of the crossed cells, and collect points inside cells.
    const VertexNumbers numbers(edges_, brick);
    Triangle* triangle = mesh.triangles.data() + bricks_[i].first_triangle;
    positions.clear();
    for_each_bit(values.crossed_cells(), [&](int bit) {
      const CellTriangles& found = triangles_of(plain, values, bit, isovalue);
      const std::int64_t inside =
          bricks_[i].first_inside + static_cast<std::int64_t>(positions.size());
      const std::uint8_t* corner = found.corner;
      const int cell = Values::place(bit);
      for (int t = 0; t < found.count; ++t, ++triangle) {
        for (int k = 0; k < 3; ++k, ++corner) {
          (*triangle)[k] = *corner < 12 ? numbers.at(cell + offset[*corner])
                                        : static_cast<std::int32_t>(inside + *corner - 12);
        }
        if (mirrored) std::swap((*triangle)[1], (*triangle)[2]);
      }
      for (int n = 0; n < found.inside; ++n) {
        positions.push_back(to_vector<3>(values.voxel(bit)) +
                            point_inside(found, n, corners_of(values, bit, isovalue)));
      }
    });
    // Fill in the vertices inside cells, which are the last ones of the mesh.
    place(bricks_[i].first_inside, positions);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bricks_.size(), grain),
                    [&](const auto& range) {
                      std::vector<Vec3> positions;
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        fill_brick(i, positions);
                      }
                    });
}

void drop_unused_vertices(IsosurfaceMesh& mesh) {
  drop_unused_vertices(mesh.vertices, mesh.normals, mesh.triangles);
}

void contour(const Field<3>& field, double isovalue, bool normals, IsosurfaceMesh& mesh) {
  MarchingCubes(field, isovalue).fill(mesh, normals);
  if (field.masked) drop_unused_vertices(mesh);
}

IsosurfaceMesh contour(const Field<3>& field, double isovalue) {
  IsosurfaceMesh mesh;
  contour(field, isovalue, true, mesh);
  return mesh;
}

}  // namespace leaflight
