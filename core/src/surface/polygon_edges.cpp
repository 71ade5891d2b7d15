// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_edges.h"

#include <algorithm>
#include <numeric>

namespace leaflight {
namespace {

// An edge, seen from its lower vertex.
struct Side {
  std::int32_t higher;
  std::int32_t corner;

  bool operator<(const Side& other) const {
    return higher != other.higher ? higher < other.higher : corner < other.corner;
  }
};

// Calls visit(corner, its vertex, the next corner's vertex).
template <class Visit>
void for_each_side(const std::int32_t* corners, std::size_t polygons, int sides, Visit visit) {
  for (std::size_t polygon = 0; polygon < polygons; ++polygon) {
    const std::size_t first = polygon * sides;
    for (int k = 0; k < sides; ++k) {
      const int next = k + 1 < sides ? k + 1 : 0;
      visit(static_cast<std::int32_t>(first + k), corners[first + k], corners[first + next]);
    }
  }
}

}  // namespace

PolygonEdges polygon_edges(const std::int32_t* corners, std::size_t polygons, int sides,
                           std::size_t vertices) {
  // Counting sort by the lower vertex; few edges share one, so the remaining sort is fast.
  std::vector<std::uint32_t> first(vertices + 1, 0);
  for_each_side(corners, polygons, sides, [&](std::int32_t, std::int32_t a, std::int32_t b) {
    ++first[static_cast<std::size_t>(std::min(a, b)) + 1];
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Side> around(polygons * sides);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for_each_side(corners, polygons, sides, [&](std::int32_t corner, std::int32_t a, std::int32_t b) {
    around[next[std::min(a, b)]++] = {std::max(a, b), corner};
  });

  PolygonEdges edges;
  edges.vertices.reserve(around.size() / 2 + vertices);
  edges.corner_edge.resize(around.size());
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto begin = around.begin() + first[v], end = around.begin() + first[v + 1];
    std::sort(begin, end);
    for (auto side = begin; side != end; ++side) {
      if (side == begin || side->higher != (side - 1)->higher) {
        edges.vertices.push_back({static_cast<std::int32_t>(v), side->higher});
      }
      edges.corner_edge[side->corner] = static_cast<std::int32_t>(edges.vertices.size() - 1);
    }
  }
  return edges;
}

}  // namespace leaflight
