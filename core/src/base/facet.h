// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/vector.h"

namespace leaflight {

// Returns the normal of an edge, to its left, or of two edges in space, right-handed. Its length is
// the length of the segment or the area of the parallelogram.
inline Vec<2> scaled_normal(const std::array<Vec<2>, 1>& edges) {
  return {-edges[0].y, edges[0].x};
}
inline Vec<3> scaled_normal(const std::array<Vec<3>, 2>& edges) { return edges[0].cross(edges[1]); }

// Moves a position along the normal, out of the plane of its triangle (pbrt 3, ch. 3.9). The
// distance covers rounding errors of single precision.
template <int D>
Vec<D> leave_plane(const Vec<D>& position, const Vec<D>& normal) {
  double size = 1;
  for (int a = 0; a < D; ++a) size += std::abs(position[a]);
  return position + normal * (size * 8 * std::numeric_limits<float>::epsilon());
}

// The points of a facet as corner + u edge_0 + v edge_1; a segment has no second edge.
template <int D>
struct FacetFrame {
  Vec<D> corner;
  std::array<Vec<D>, static_cast<std::size_t>(D - 1)> edges;

  template <class Mesh>
  FacetFrame(const Mesh& mesh, std::size_t facet) {
    const auto& indices = mesh.facets[facet];
    corner = Vec<D>(mesh.vertices[indices[0]]);
    for (int i = 0; i < D - 1; ++i) edges[i] = Vec<D>(mesh.vertices[indices[i + 1]]) - corner;
  }
  Vec<D> point(double u, double v) const {
    if constexpr (D == 2) {
      return corner + edges[0] * u;
    } else {
      return corner + edges[0] * u + edges[1] * v;
    }
  }
  Vec<D> normal() const { return scaled_normal(edges).normalized(); }
  double area() const { return scaled_normal(edges).length() / (D - 1); }
};

}  // namespace leaflight
