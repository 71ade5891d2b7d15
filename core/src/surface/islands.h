// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vector.h"

namespace leaflight {

// Returns, for each vertex, the least vertex of its connected part. Triangles are connected if they
// share a vertex.
std::vector<std::int32_t> connected_parts(const std::array<std::int32_t, 3>* triangles,
                                          std::size_t triangle_count, std::size_t vertex_count);

// The connected parts of a mesh whose extent along some axis is at least `smallest`.
struct LargeParts {
  std::vector<std::int32_t> vertices;                  // of the mesh, in its order
  std::vector<std::array<std::int32_t, 3>> triangles;  // by indices in `vertices`
};

LargeParts large_parts(const Vec<3, float>* vertices, std::size_t vertex_count,
                       const std::array<std::int32_t, 3>* triangles, std::size_t triangle_count,
                       float smallest);

}  // namespace leaflight
