// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/crossed_edges.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <string>

#include "leaflight/math/error.h"

namespace leaflight {

template <int D>
CrossedEdges<D>::CrossedEdges(const Field<D>& field, double isovalue)
    : field_(field),
      isovalue_(isovalue),
      level_(field.pyramid.levels[0]),
      slot_(level_.bricks.size(), -1) {
  stride_[0] = 1;
  for (int a = 1; a < D; ++a) stride_[a] = stride_[a - 1] * field.dims[a - 1];
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
  count_ = static_cast<std::size_t>(vertices);
}

// Bricks with crossed cells, and those that own edges of such cells.
template <int D>
void CrossedEdges<D>::find_bricks() {
  for_each_index<D>({}, level_.dims, [&](const Index<D>& brick) {
    if (!level_.at(brick).crossed_by(isovalue_)) return;
    crossed_.push_back(brick);
    Index<D> behind;
    for (int a = 0; a < D; ++a) behind[a] = std::min(brick[a] + 2, level_.dims[a]);
    for_each_index<D>(brick, behind, [&](const Index<D>& owner) {
      slot_[linear_number<D>(owner, level_.dims)] = 0;
    });
  });
  for_each_index<D>({}, level_.dims, [&](const Index<D>& brick) {
    std::int32_t& slot = slot_[linear_number<D>(brick, level_.dims)];
    if (slot < 0) return;
    slot = static_cast<std::int32_t>(edges_.size());
    edges_.push_back({brick, {}, 0});
  });
}

template <int D>
void CrossedEdges<D>::mark(BrickEdges& e) const {
  for_each_voxel(e.brick, 0, [&](const Index<D>& i) {
    const float* h = field_.values + field_.offset(i);
    const bool above = *h >= isovalue_;
    for (int a = 0; a < D; ++a) {
      if (i[a] + 1 >= field_.dims[a]) continue;
      const float other = h[stride_[a]];
      if (above == (other >= isovalue_) || std::isnan(*h) || std::isnan(other)) continue;
      e.crossed[a] |= std::uint64_t{1} << bit_of(i);
    }
  });
}

template <int D>
void CrossedEdges<D>::place(std::vector<Vec<D, float>>& vertices,
                            std::vector<Vec<D, float>>& normals) const {
  vertices.resize(count_);
  normals.resize(count_);
  tbb::parallel_for(std::size_t{0}, edges_.size(), [&](std::size_t n) {
    const BrickEdges& e = edges_[n];
    if (e.count() == 0) return;
    for_each_voxel(e.brick, 0, [&](const Index<D>& i) {
      const int bit = bit_of(i);
      for (int a = 0; a < D; ++a) {
        if (!((e.crossed[a] >> bit) & 1)) continue;
        const float* h = field_.values + field_.offset(i);
        // The two values lie on different sides, so they differ.
        const double low = *h, high = h[stride_[a]];
        Vec<D> position = to_vector<D>(i);
        position[a] += (isovalue_ - low) / (high - low);
        const std::int64_t v = e.number(a, bit);
        vertices[v] = Vec<D, float>(field_.index_to_world.point(position));
        normals[v] = Vec<D, float>(shading_normal(field_, position));
      }
    });
  });
}

template class CrossedEdges<2>;
template class CrossedEdges<3>;

}  // namespace leaflight
