// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/islands.h"

#include <algorithm>

#include "base/disjoint_sets.h"

namespace leaflight {

std::vector<std::int32_t> connected_parts(const std::array<std::int32_t, 3>* triangles,
                                          std::size_t triangle_count, std::size_t vertex_count) {
  DisjointSets<std::int32_t> sets(vertex_count);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    sets.join(triangles[t][0], triangles[t][1]);
    sets.join(triangles[t][1], triangles[t][2]);
  }
  return sets.names();
}

LargeParts large_parts(const Vec<3, float>* vertices, std::size_t vertex_count,
                       const std::array<std::int32_t, 3>* triangles, std::size_t triangle_count,
                       float smallest) {
  const std::vector<std::int32_t> parts = connected_parts(triangles, triangle_count, vertex_count);
  // The box of each part, at the index of its least vertex.
  std::vector<Vec<3, float>> low(vertices, vertices + vertex_count), high(low);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const std::int32_t part = parts[v];
    for (int a = 0; a < 3; ++a) {
      low[part][a] = std::min(low[part][a], vertices[v][a]);
      high[part][a] = std::max(high[part][a], vertices[v][a]);
    }
  }
  constexpr std::int32_t absent = -1;
  LargeParts kept;
  std::vector<std::int32_t> number(vertex_count, absent);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const Vec<3, float> size = high[parts[v]] - low[parts[v]];
    if (std::max({size.x, size.y, size.z}) < smallest) continue;
    number[v] = static_cast<std::int32_t>(kept.vertices.size());
    kept.vertices.push_back(static_cast<std::int32_t>(v));
  }
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const auto [a, b, c] = triangles[t];
    if (number[a] != absent) kept.triangles.push_back({number[a], number[b], number[c]});
  }
  return kept;
}

}  // namespace leaflight
