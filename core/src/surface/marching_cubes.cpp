// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/marching_cubes.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>

#include "leaflight/math/error.h"
#include "leaflight/surface/cell_polygons.h"
#include "leaflight/surface/edge_vertex.h"

namespace leaflight {
namespace {

constexpr int log2_brick = IntervalPyramid<3>::log2_brick;
constexpr int brick_size = 1 << log2_brick;

// The crossed edges owned by the voxels of a brick, one bit each, per axis; an edge belongs to its
// lower voxel. A vertex's number is the brick's first plus the rank of its bit.
struct BrickEdges {
  Index<3> brick;
  std::array<std::uint64_t, 3> crossed{};
  std::int64_t first = 0;

  int count() const {
    return __builtin_popcountll(crossed[0]) + __builtin_popcountll(crossed[1]) +
           __builtin_popcountll(crossed[2]);
  }
  std::int64_t vertex(int axis, int bit) const {
    std::int64_t number = first;
    for (int a = 0; a < axis; ++a) number += __builtin_popcountll(crossed[a]);
    return number + __builtin_popcountll(crossed[axis] & ((std::uint64_t{1} << bit) - 1));
  }
};

int bit_of(const Index<3>& voxel) {
  constexpr int mask = brick_size - 1;
  return (((voxel[2] & mask) << log2_brick | (voxel[1] & mask)) << log2_brick) | (voxel[0] & mask);
}

class Contour {
 public:
  Contour(const Field<3>& field, double isovalue)
      : field_(field),
        isovalue_(isovalue),
        bricks_(field.pyramid.levels[0]),
        slot_(bricks_.bricks.size(), -1) {}

  IsosurfaceMesh run() {
    find_bricks();
    tbb::parallel_for(std::size_t{0}, edges_.size(), [&](std::size_t i) { mark(edges_[i]); });
    std::int64_t vertices = 0;
    for (BrickEdges& e : edges_) {
      e.first = vertices;
      vertices += e.count();
    }
    if (vertices > std::numeric_limits<std::int32_t>::max()) {
      throw Error("The isosurface has " + std::to_string(vertices) +
                  " vertices, more than a mesh can hold; reduce the volume's resolution.");
    }
    mesh_.vertices.resize(vertices);
    mesh_.normals.resize(vertices);
    tbb::parallel_for(std::size_t{0}, edges_.size(), [&](std::size_t i) { place(edges_[i]); });
    connect();
    if (field_.masked) drop_unused_vertices();
    return std::move(mesh_);
  }

 private:
  std::size_t linear(const Index<3>& brick) const { return linear_number<3>(brick, bricks_.dims); }

  // Bricks with crossed cells, and those that own edges of such cells.
  void find_bricks() {
    for_each_index<3>({}, bricks_.dims, [&](const Index<3>& brick) {
      if (!bricks_.at(brick).crossed_by(isovalue_)) return;
      crossed_.push_back(brick);
      Index<3> behind;
      for (int a = 0; a < 3; ++a) behind[a] = std::min(brick[a] + 2, bricks_.dims[a]);
      for_each_index<3>(brick, behind, [&](const Index<3>& owner) { slot_[linear(owner)] = 0; });
    });
    for_each_index<3>({}, bricks_.dims, [&](const Index<3>& brick) {
      std::int32_t& slot = slot_[linear(brick)];
      if (slot < 0) return;
      slot = static_cast<std::int32_t>(edges_.size());
      edges_.push_back({brick, {}, 0});
    });
  }

  template <class Visit>
  void for_each_voxel(const Index<3>& brick, int margin, Visit visit) const {
    Index<3> low, high;
    for (int a = 0; a < 3; ++a) {
      low[a] = brick[a] << log2_brick;
      high[a] = std::min(low[a] + brick_size, field_.dims[a] - margin);
    }
    for_each_index<3>(low, high, visit);
  }

  std::size_t stride(int axis) const {
    return axis == 0   ? 1
           : axis == 1 ? field_.dims[0]
                       : static_cast<std::size_t>(field_.dims[0]) * field_.dims[1];
  }

  void mark(BrickEdges& e) const {
    for_each_voxel(e.brick, 0, [&](const Index<3>& i) {
      const float* h = field_.values + field_.offset(i);
      const bool above = *h >= isovalue_;
      for (int a = 0; a < 3; ++a) {
        if (i[a] + 1 >= field_.dims[a]) continue;
        const float other = h[stride(a)];
        if (above == (other >= isovalue_) || std::isnan(*h) || std::isnan(other)) continue;
        e.crossed[a] |= std::uint64_t{1} << bit_of(i);
      }
    });
  }

  void place(const BrickEdges& e) {
    if (e.count() == 0) return;
    for_each_voxel(e.brick, 0, [&](const Index<3>& i) {
      const int bit = bit_of(i);
      for (int a = 0; a < 3; ++a) {
        if (!((e.crossed[a] >> bit) & 1)) continue;
        const EdgeVertex<3> vertex = edge_vertex(field_, i, a, isovalue_);
        const std::int64_t v = e.vertex(a, bit);
        mesh_.vertices[v] = vertex.position;
        mesh_.normals[v] = vertex.normal;
      }
    });
  }

  std::int32_t vertex(const Index<3>& cell, int edge) const {
    const CellEdge e = cell_edge(edge);
    Index<3> voxel, brick;
    for (int a = 0; a < 3; ++a) {
      voxel[a] = cell[a] + ((e.corner >> a) & 1);
      brick[a] = voxel[a] >> log2_brick;
    }
    return static_cast<std::int32_t>(edges_[slot_[linear(brick)]].vertex(e.axis, bit_of(voxel)));
  }

  void connect() {
    std::vector<std::vector<std::array<std::int32_t, 3>>> pieces(crossed_.size());
    // Outside is in front in index coordinates; a mirroring transform turns that around.
    const bool mirrored = determinant(field_.index_to_world) < 0;
    tbb::parallel_for(std::size_t{0}, crossed_.size(), [&](std::size_t p) {
      for_each_voxel(crossed_[p], 1, [&](const Index<3>& cell) {
        CellCorners<3> corners = load_corners(field_, cell);
        unsigned above = 0;
        bool masked = false;
        for (int i = 0; i < 8; ++i) {
          above |= static_cast<unsigned>(corners.h[i] >= isovalue_) << i;
          masked |= std::isnan(corners.h[i]);
          corners.h[i] -= isovalue_;
        }
        if (above == 0 || above == 255 || masked) return;
        const CellTriangles& triangles = cell_triangles(above, joined_faces(corners.h, above));
        for (int t = 0; t < triangles.count; ++t) {
          std::array<std::int32_t, 3> v;
          for (int k = 0; k < 3; ++k) v[k] = vertex(cell, triangles.edge[3 * t + k]);
          if (mirrored) std::swap(v[1], v[2]);
          pieces[p].push_back(v);
        }
      });
    });
    std::size_t total = 0;
    for (const auto& piece : pieces) total += piece.size();
    mesh_.triangles.reserve(total);
    for (const auto& piece : pieces) {
      mesh_.triangles.insert(mesh_.triangles.end(), piece.begin(), piece.end());
    }
  }

  // Edges between masked cells are crossed but belong to no triangle.
  void drop_unused_vertices() {
    std::vector<std::int32_t> number(mesh_.vertices.size(), -1);
    for (const auto& triangle : mesh_.triangles) {
      for (const std::int32_t v : triangle) number[v] = 0;
    }
    std::int32_t used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] < 0) continue;
      mesh_.vertices[used] = mesh_.vertices[v];
      mesh_.normals[used] = mesh_.normals[v];
      number[v] = used++;
    }
    mesh_.vertices.resize(used);
    mesh_.normals.resize(used);
    for (auto& triangle : mesh_.triangles) {
      for (std::int32_t& v : triangle) v = number[v];
    }
  }

  const Field<3>& field_;
  const double isovalue_;
  const IntervalPyramid<3>::Level& bricks_;
  std::vector<std::int32_t> slot_;  // brick -> place in edges_, or -1
  std::vector<Index<3>> crossed_;
  std::vector<BrickEdges> edges_;
  IsosurfaceMesh mesh_;
};

}  // namespace

IsosurfaceMesh contour(const Field<3>& field, double isovalue) {
  return Contour(field, isovalue).run();
}

}  // namespace leaflight
