// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace leaflight {

MeshEdges::MeshEdges(std::size_t vertices, const std::vector<Triangle>& triangles,
                     const std::function<bool(std::int32_t, std::int32_t)>& wanted)
    : first_(vertices + 1, 0), others_(3 * triangles.size()), number_(vertices + 1, 0) {
  const auto for_each_side = [&](const auto& visit) {
    tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
        visit(std::min(a, b), std::max(a, b));
      }
    });
  };
  std::vector<std::atomic<std::uint32_t>> next(vertices);
  for_each_side([&](std::int32_t lower, std::int32_t) {
    next[lower].fetch_add(1, std::memory_order_relaxed);
  });
  for (std::size_t v = 0; v < vertices; ++v) {
    first_[v + 1] = first_[v] + next[v];
    next[v] = first_[v];
  }
  for_each_side([&](std::int32_t lower, std::int32_t other) {
    others_[next[lower].fetch_add(1, std::memory_order_relaxed)] = other;
  });
  tbb::parallel_for(std::size_t{0}, vertices, [&](std::size_t v) {
    const auto begin = others_.begin() + first_[v], end = others_.begin() + first_[v + 1];
    // Sort, because the threads' order is arbitrary, and remove the duplicates of most edges.
    std::sort(begin, end);
    const auto lower = static_cast<std::int32_t>(v);
    const auto kept = std::remove_if(begin, std::unique(begin, end),
                                     [&](std::int32_t other) { return !wanted(lower, other); });
    number_[v + 1] = static_cast<std::int32_t>(kept - begin);
  });
  std::partial_sum(number_.begin(), number_.end(), number_.begin());
}

std::int32_t MeshEdges::operator()(std::int32_t a, std::int32_t b) const {
  const std::int32_t lower = std::min(a, b), other = std::max(a, b);
  for (std::int32_t n = number_[lower]; n < number_[lower + 1]; ++n) {
    if (others_[first_[lower] + (n - number_[lower])] == other) return n;
  }
  return absent;
}

}  // namespace leaflight
