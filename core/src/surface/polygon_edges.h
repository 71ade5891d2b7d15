// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/parallel.h"

namespace leaflight {

// The unique edges of a mesh, numbered by their lower vertex and then by the other one. The numbers
// do not depend on threads.
class PolygonEdges {
 public:
  // wanted(lower vertex, other vertex): false for edges to leave out; called once for each edge,
  // from several threads.
  using Wanted = std::function<bool(std::int32_t, std::int32_t)>;

  // Finds the edges of polygons with `sides` sides each. corners: vertices of all polygons in turn,
  // each in [0, vertices); fewer than 2^31 corners.
  PolygonEdges(const std::int32_t* corners, std::size_t polygons, int sides, std::size_t vertices,
               const Wanted& wanted = {});

  std::size_t count() const { return number_.back(); }
  std::size_t corners() const { return sides_.size(); }
  // Calls at_edge(number, lower vertex, other vertex) for each edge, and then at_corner(corner,
  // number) for each corner from which it leads to the next corner of a polygon. Calls come from
  // several threads.
  template <class AtEdge, class AtCorner>
  void visit(AtEdge at_edge, AtCorner at_corner) const {
    parallel_each(first_.size() - 1, [&](std::size_t v) {
      auto number = static_cast<std::int32_t>(number_[v]) - 1;
      std::int32_t other = left_out;
      for (std::size_t i = first_[v]; i < first_[v + 1] && sides_[i].other != left_out; ++i) {
        if (sides_[i].other != other) {
          other = sides_[i].other;
          at_edge(++number, static_cast<std::int32_t>(v), other);
        }
        at_corner(sides_[i].corner, number);
      }
    });
  }

 private:
  // Vertices are not negative, so this is none.
  static constexpr std::int32_t left_out = -1;

  // A side of a polygon, seen from its lower vertex.
  struct Side {
    std::int32_t other;   // vertex, or left_out in place of sides that are
    std::int32_t corner;  // from which the side leads to the next corner
  };

  // Sorts the sides of a vertex by edge, and drops those that are not wanted. Returns the number of
  // edges.
  std::uint32_t sort(std::int32_t lower, const Wanted& wanted);

  std::vector<std::uint32_t> first_;  // first side of each vertex, and the end
  std::vector<Side> sides_;
  std::vector<std::uint32_t> number_;  // first edge of each vertex, and the number of all edges
};

}  // namespace leaflight
