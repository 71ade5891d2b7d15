// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_edges.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace leaflight {

PolygonEdges::PolygonEdges(const std::int32_t* corners, std::size_t polygons, int sides,
                           std::size_t vertices, const Wanted& wanted)
    : first_(vertices + 1, 0), sides_(polygons * sides), number_(vertices + 1, 0) {
  const auto for_each_side = [&](const auto& visit) {
    parallel_each(polygons, [&](std::size_t polygon) {
      const std::size_t first = polygon * sides;
      for (int k = 0; k < sides; ++k) {
        const std::int32_t a = corners[first + k], b = corners[first + (k + 1 < sides ? k + 1 : 0)];
        visit(std::min(a, b), Side{std::max(a, b), static_cast<std::int32_t>(first + k)});
      }
    });
  };
  // Counting sort by the lower vertex. Few sides share one, so the remaining sort is fast.
  std::vector<std::atomic<std::uint32_t>> next(vertices);
  for_each_side([&](std::int32_t lower, const Side&) {
    next[lower].fetch_add(1, std::memory_order_relaxed);
  });
  for (std::size_t v = 0; v < vertices; ++v) {
    first_[v + 1] = first_[v] + next[v];
    next[v] = first_[v];
  }
  for_each_side([&](std::int32_t lower, const Side& side) {
    sides_[next[lower].fetch_add(1, std::memory_order_relaxed)] = side;
  });
  parallel_each(vertices, [&](std::size_t v) {
    number_[v + 1] = sort(static_cast<std::int32_t>(v), wanted);
  });
  std::partial_sum(number_.begin(), number_.end(), number_.begin());
}

std::uint32_t PolygonEdges::sort(std::int32_t lower, const Wanted& wanted) {
  const auto begin = sides_.begin() + first_[lower], end = sides_.begin() + first_[lower + 1];
  // Threads add the sides in any order.
  std::sort(begin, end, [](const Side& a, const Side& b) {
    return a.other != b.other ? a.other < b.other : a.corner < b.corner;
  });
  auto kept = begin;
  std::uint32_t edges = 0;
  std::int32_t other = left_out;
  bool is_wanted = true;
  for (auto side = begin; side != end; ++side) {
    if (side->other != other) {
      other = side->other;
      is_wanted = !wanted || wanted(lower, other);
      edges += is_wanted ? 1 : 0;
    }
    if (is_wanted) *kept++ = *side;
  }
  if (kept != end) kept->other = left_out;
  return edges;
}

}  // namespace leaflight
