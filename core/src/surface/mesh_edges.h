// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace leaflight {

// Selected edges of a mesh, numbered by their lower vertex and then by the other one. Only the few
// edges of each vertex are sorted. The numbers do not depend on threads.
class MeshEdges {
 public:
  using Triangle = std::array<std::int32_t, 3>;
  static constexpr std::int32_t absent = -1;

  // wanted(lower vertex, other vertex): called once for each edge, from several threads.
  MeshEdges(std::size_t vertices, const std::vector<Triangle>& triangles,
            const std::function<bool(std::int32_t, std::int32_t)>& wanted);

  std::size_t count() const { return static_cast<std::size_t>(number_.back()); }
  // Returns the number of the edge between two vertices, or absent.
  std::int32_t operator()(std::int32_t a, std::int32_t b) const;
  // Calls visit(number, other vertex) for each selected edge with this lower vertex.
  template <class Visit>
  void for_each_at(std::int32_t lower, Visit visit) const {
    for (std::int32_t n = number_[lower]; n < number_[lower + 1]; ++n) {
      visit(n, others_[first_[lower] + (n - number_[lower])]);
    }
  }

 private:
  std::vector<std::uint32_t> first_;  // start of each vertex in others_
  std::vector<std::int32_t> others_;
  // First edge of each vertex; at the end, the number of all edges.
  std::vector<std::int32_t> number_;
};

}  // namespace leaflight
