// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "leaflight/field/field.h"
#include "leaflight/math/platform.h"

namespace leaflight {

// The edges of the grid that a leaf crosses: the vertices of its contour. Only the bricks whose
// interval holds the isovalue are visited; edges are numbered by bit counts within bricks, without
// hashing or sorting, and belong to their lower voxel. The numbers do not depend on threads.
template <int D>
class CrossedEdges {
 public:
  // Throws Error when there are more than 2^31 crossed edges.
  CrossedEdges(const Field<D>& field, double isovalue);

  std::size_t count() const { return count_; }
  // The bricks of cells that the leaf may pass.
  const std::vector<Index<D>>& bricks() const { return crossed_; }

  // The number of the crossed edge from a voxel along an axis.
  std::int32_t number(const Index<D>& voxel, int axis) const {
    Index<D> brick;
    for (int a = 0; a < D; ++a) brick[a] = voxel[a] >> log2_brick;
    return static_cast<std::int32_t>(
        edges_[slot_[linear_number<D>(brick, level_.dims)]].number(axis, bit_of(voxel)));
  }

  // Where the linear interpolant along each edge is the isovalue (world), and the unit normals of
  // the shading gradient there, towards lower values; zero where the gradient vanishes.
  void place(std::vector<Vec<D, float>>& vertices, std::vector<Vec<D, float>>& normals) const;

  // Calls visit(cell) for the cells of a brick.
  template <class Visit>
  void for_each_cell(const Index<D>& brick, Visit visit) const {
    for_each_voxel(brick, 1, visit);
  }

 private:
  static constexpr int log2_brick = IntervalPyramid<D>::log2_brick;
  static constexpr int brick_size = 1 << log2_brick;

  // The crossed edges owned by the voxels of a brick, one bit each, per axis. An edge's number is
  // the brick's first plus the rank of its bit.
  struct BrickEdges {
    Index<D> brick;
    std::array<std::uint64_t, static_cast<std::size_t>(D)> crossed{};
    std::int64_t first = 0;

    int count() const {
      int n = 0;
      for (const std::uint64_t bits : crossed) n += count_ones(bits);
      return n;
    }
    std::int64_t number(int axis, int bit) const {
      std::int64_t n = first;
      for (int a = 0; a < axis; ++a) n += count_ones(crossed[a]);
      return n + count_ones(crossed[axis] & ((std::uint64_t{1} << bit) - 1));
    }
  };

  static int bit_of(const Index<D>& voxel) {
    int bit = 0;
    for (int a = D - 1; a >= 0; --a) bit = (bit << log2_brick) | (voxel[a] & (brick_size - 1));
    return bit;
  }

  template <class Visit>
  void for_each_voxel(const Index<D>& brick, int margin, Visit visit) const {
    Index<D> low, high;
    for (int a = 0; a < D; ++a) {
      low[a] = brick[a] << log2_brick;
      high[a] = std::min(low[a] + brick_size, field_.dims[a] - margin);
    }
    for_each_index<D>(low, high, visit);
  }

  void find_bricks();
  void mark(BrickEdges& e) const;

  const Field<D>& field_;
  const double isovalue_;
  const typename IntervalPyramid<D>::Level& level_;
  std::array<std::size_t, static_cast<std::size_t>(D)> stride_;  // of the voxels
  std::vector<std::int32_t> slot_;                               // brick -> place in edges_, or -1
  std::vector<Index<D>> crossed_;
  std::vector<BrickEdges> edges_;
  std::size_t count_ = 0;
};

// Edges between masked cells are crossed but belong to no facet: removes their vertices.
template <class Vertex, class Facet>
void drop_unused_vertices(std::vector<Vertex>& vertices, std::vector<Vertex>& normals,
                          std::vector<Facet>& facets) {
  std::vector<std::int32_t> number(vertices.size(), -1);
  for (const Facet& facet : facets) {
    for (const std::int32_t v : facet) number[v] = 0;
  }
  std::int32_t used = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    vertices[used] = vertices[v];
    normals[used] = normals[v];
    number[v] = used++;
  }
  vertices.resize(used);
  normals.resize(used);
  for (Facet& facet : facets) {
    for (std::int32_t& v : facet) v = number[v];
  }
}

}  // namespace leaflight
