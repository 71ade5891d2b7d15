// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace leaflight {

// The vertices that share a facet with each vertex, which is itself the first of them.
class MeshNeighbors {
 public:
  MeshNeighbors() = default;
  template <class Facet>
  MeshNeighbors(std::size_t vertices, const std::vector<Facet>& facets) : begins_(vertices + 1) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Facet& facet : facets) {
      for (const std::uint32_t a : facet) {
        for (const std::uint32_t b : facet) {
          if (a != b) pairs.emplace_back(a, b);
        }
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::size_t pair = 0;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      vertices_.push_back(v);
      for (; pair < pairs.size() && pairs[pair].first == v; ++pair) {
        vertices_.push_back(pairs[pair].second);
      }
      begins_[v + 1] = vertices_.size();
    }
  }

  const std::uint32_t* begin(std::size_t v) const { return vertices_.data() + begins_[v]; }
  const std::uint32_t* end(std::size_t v) const { return vertices_.data() + begins_[v + 1]; }

 private:
  std::vector<std::size_t> begins_;
  std::vector<std::uint32_t> vertices_;
};

}  // namespace leaflight
