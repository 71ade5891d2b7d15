// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace leaflight {

// The triangles about each vertex of a mesh, in ascending order.
class VertexFans {
 public:
  VertexFans(std::size_t vertices, const std::vector<std::array<std::int32_t, 3>>& triangles);

  std::size_t size(std::size_t vertex) const { return first_[vertex + 1] - first_[vertex]; }
  // The two other corners of the i-th triangle about a vertex.
  const std::array<std::int32_t, 2>& others(std::size_t vertex, std::size_t i) const {
    return others_[first_[vertex] + i];
  }

 private:
  std::vector<std::uint32_t> first_;  // of each vertex, and the number of all
  std::vector<std::array<std::int32_t, 2>> others_;
};

}  // namespace leaflight
