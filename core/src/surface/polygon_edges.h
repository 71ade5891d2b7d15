// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace leaflight {

// The edges of a mesh, each once however many polygons share it, for programs that store them.
struct PolygonEdges {
  std::vector<std::array<std::int32_t, 2>> vertices;  // lower vertex first, ascending
  std::vector<std::int32_t> of_corner;  // from each corner to the next one of its polygon
};

// Of polygons that have so many sides each. corners: their vertices, polygon by polygon, each in
// [0, vertices); fewer than 2^31 of them.
PolygonEdges polygon_edges(const std::int32_t* corners, std::size_t polygons, int sides,
                           std::size_t vertices);

}  // namespace leaflight
