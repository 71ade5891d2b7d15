// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cell_polygons.h"

namespace leaflight {
namespace {

int edge_between(int a, int b) {
  const int difference = a ^ b;
  const int axis = difference == 1 ? 0 : difference == 2 ? 1 : 2;
  const int low = a & b;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return 4 * axis + ((low >> first) & 1) + 2 * ((low >> second) & 1);
}

}  // namespace

CellEdge cell_edge(int edge) {
  const int axis = edge / 4;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return {axis, ((edge & 1) << first) | (((edge >> 1) & 1) << second)};
}

std::array<int, 4> face_corners(int face) {
  const int axis = face / 2, side = face % 2;
  const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3);
  const int base = side << axis;
  if (side == 1) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

unsigned alternating_faces(unsigned above) {
  unsigned faces = 0;
  for (int face = 0; face < 6; ++face) {
    const auto corner = face_corners(face);
    const auto is_above = [&](int i) { return (above >> corner[i]) & 1u; };
    if (is_above(0) != is_above(1) && is_above(0) == is_above(2) && is_above(1) == is_above(3)) {
      faces |= 1u << face;
    }
  }
  return faces;
}

unsigned joined_faces(const std::array<double, 8>& g, unsigned above) {
  unsigned joined = 0;
  const unsigned alternating = alternating_faces(above);
  for (int face = 0; face < 6; ++face) {
    if (!((alternating >> face) & 1u)) continue;
    const auto corner = face_corners(face);
    const double even = g[corner[0]] * g[corner[2]], odd = g[corner[1]] * g[corner[3]];
    // h == c counts as above, hence >= for the saddle.
    const bool first_above = (above >> corner[0]) & 1u;
    if (first_above ? even >= odd : odd >= even) joined |= 1u << face;
  }
  return joined;
}

// Walks the faces. On each, the surface leaves through the edge where the walk goes from above to
// below. It returns through an edge from below to above, with the above on the left.
std::vector<std::vector<int>> cell_polygons(unsigned above, unsigned joined) {
  std::array<int, 12> next;
  next.fill(-1);
  const auto is_above = [&](int corner) { return (above >> corner) & 1u; };
  for (int face = 0; face < 6; ++face) {
    const auto corner = face_corners(face);
    for (int i = 0; i < 4; ++i) {
      const int a = corner[i], b = corner[(i + 1) % 4];
      if (!is_above(a) || is_above(b)) continue;
      // If joined, go around the next run below; if separate, around the run above that ends here.
      int from = -1;
      const int step = ((joined >> face) & 1u) ? 1 : 3;
      for (int j = (i + step) % 4; from < 0; j = (j + step) % 4) {
        if (!is_above(corner[j]) && is_above(corner[(j + 1) % 4])) {
          from = edge_between(corner[j], corner[(j + 1) % 4]);
        }
      }
      next[edge_between(a, b)] = from;
    }
  }
  std::vector<std::vector<int>> polygons;
  for (int start = 0; start < 12; ++start) {
    if (next[start] < 0) continue;
    std::vector<int>& polygon = polygons.emplace_back();
    for (int edge = start; next[edge] >= 0;) {
      polygon.push_back(edge);
      const int following = next[edge];
      next[edge] = -1;
      edge = following;
    }
  }
  return polygons;
}

}  // namespace leaflight
