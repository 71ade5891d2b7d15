// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/platform.h"
#include "surface/brick_values.h"

namespace leaflight {

// The edges of the grid that an isosurface crosses, which are the vertices of its contour. Visits
// only bricks whose interval contains the isovalue, by the levels of the pyramid. Edges belong to
// their lower voxel. Bit counts within bricks number them, without hashing or sorting. The numbers
// do not depend on threads.
template <int D>
class CrossedEdges {
 public:
  // The crossed edges of a brick's voxels, as in BrickValues. An edge's number is the brick's first
  // number plus the rank of its bit.
  struct BrickEdges {
    Index<D> brick;
    std::array<std::uint64_t, static_cast<std::size_t>(D)> edges{};
    std::int64_t first = 0;

    int count() const {
      int n = 0;
      for (const std::uint64_t bits : edges) n += count_ones(bits);
      return n;
    }
    std::int64_t number(int axis, int bit) const {
      std::int64_t n = first;
      for (int a = 0; a < axis; ++a) n += count_ones(edges[a]);
      return n + count_ones(edges[axis] & ((std::uint64_t{1} << bit) - 1));
    }
  };

  // Finds the bricks. `field` must outlive this.
  CrossedEdges(const Field<D>& field, double isovalue);

  // Finds the edges. Calls visit(index in bricks(), values of the brick) for each brick when its
  // edges are known, from several threads. Throws Error if there are more than 2^31 crossed edges.
  using Visit = std::function<void(std::size_t, const BrickValues<D>&)>;
  void mark(const Visit& visit = nullptr);

  const Field<D>& field() const { return field_; }
  double isovalue() const { return isovalue_; }
  std::size_t count() const { return count_; }

  // Returns the bricks with cells that the isosurface may cross, and those that own edges of such
  // cells, in ascending order.
  const std::vector<BrickEdges>& bricks() const { return bricks_; }
  // Returns the brick behind another's upper faces along the axes of these bits, or itself; null if
  // no cell needs it.
  const BrickEdges* beside(const BrickEdges& brick, int axes) const {
    Index<D> at = brick.brick;
    for (int a = 0; a < D; ++a) at[a] += (axes >> a) & 1;
    for (int a = 0; a < D; ++a) {
      if (at[a] >= level_.dims[a]) return nullptr;
    }
    const std::int32_t place = place_[linear_number<D>(at, level_.dims)];
    return place < 0 ? nullptr : &bricks_[place];
  }

  // Returns the number of the crossed edge from a voxel along an axis.
  std::int32_t number(const Index<D>& voxel, int axis) const {
    constexpr int log2_brick = IntervalPyramid<D>::log2_brick;
    Index<D> brick;
    int bit = 0;
    for (int a = 0; a < D; ++a) {
      brick[a] = voxel[a] >> log2_brick;
      bit |= (voxel[a] & (BrickValues<D>::size - 1)) << (log2_brick * a);
    }
    const BrickEdges& owner = bricks_[place_[linear_number<D>(brick, level_.dims)]];
    return static_cast<std::int32_t>(owner.number(axis, bit));
  }

  // Returns the index position where the linear interpolant along an edge is the isovalue. `bit`:
  // of the edge's lower voxel.
  Vec<D> position(const BrickValues<D>& values, int axis, int bit) const {
    const int place = BrickValues<D>::place(bit);
    // The two values lie on different sides, so they differ.
    const double low = values.h[place], high = values.h[place + BrickValues<D>::stride(axis)];
    return to_vector<D>(values.voxel(bit)) + along_[axis] * ((isovalue_ - low) / (high - low));
  }

 private:
  const Field<D>& field_;
  const double isovalue_;
  const typename IntervalPyramid<D>::Level& level_;
  std::vector<std::int32_t> place_;  // index of a brick in bricks_, or -1
  std::vector<BrickEdges> bricks_;
  std::size_t count_ = 0;
  std::array<Vec<D>, static_cast<std::size_t>(D)> along_;  // unit vectors of the axes
};

// Calls visit(bit) for each bit of a word, from the lowest on.
template <class Visit>
void for_each_bit(std::uint64_t word, Visit visit) {
  for (; word != 0; word &= word - 1) visit(lowest_bit(word));
}

// Removes vertices without a facet, which are on edges between masked cells. `normals` may be
// empty.
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
    if (!normals.empty()) normals[used] = normals[v];
    number[v] = used++;
  }
  vertices.resize(used);
  if (!normals.empty()) normals.resize(used);
  for (Facet& facet : facets) {
    for (std::int32_t& v : facet) v = number[v];
  }
}

}  // namespace leaflight
