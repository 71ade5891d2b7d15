// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace leaflight {

// The unique edges of a mesh, for programs that store them.
struct PolygonEdges {
  std::vector<std::array<std::int32_t, 2>> vertices;  // lower vertex first, ascending
  std::vector<std::int32_t> corner_edge;  // edge from each corner to the next one of its polygon
};

// Returns the edges of polygons with `sides` sides each. corners: vertices of all polygons in turn,
// each in [0, vertices); fewer than 2^31 corners.
PolygonEdges polygon_edges(const std::int32_t* corners, std::size_t polygons, int sides,
                           std::size_t vertices);

}  // namespace leaflight
