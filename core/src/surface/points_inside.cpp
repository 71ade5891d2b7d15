// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/points_inside.h"

#include <algorithm>
#include <optional>

#include "field/field.h"
#include "surface/cell_polygons.h"

namespace leaflight {
namespace {

// Returns the zero of the linear interpolant along an edge.
Vec3 point_on(int edge, const std::array<double, 8>& g) {
  const auto [axis, corner] = cell_edge(edge);
  const double low = g[corner], high = g[corner | (1 << axis)];
  Vec3 point;
  for (int a = 0; a < 3; ++a) point[a] = (corner >> a) & 1;
  point[axis] = -low / (high - low);
  return point;
}

// Returns the center of the edges' points that share a triangle with a point inside.
Vec3 middle_about(const CellTriangles& triangles, int point, const std::array<double, 8>& g) {
  Vec3 sum(0.0);
  int count = 0;
  for (int t = 0; t < triangles.count; ++t) {
    const std::uint8_t* corner = triangles.corner + 3 * t;
    if (std::find(corner, corner + 3, point) == corner + 3) continue;
    for (int k = 0; k < 3; ++k) {
      if (corner[k] == point) continue;
      sum += point_on(corner[k], g);
      ++count;
    }
  }
  return sum / count;
}

// Returns the distance along a line to its first hit of the isosurface within the unit cube, in
// lengths of `along`.
std::optional<double> distance_to_isosurface(const CellCorners<3>& corners, const Vec3& from,
                                             const Vec3& along) {
  const bool side = interpolate(corners, from) >= 0;
  double end = 1;
  for (int a = 0; a < 3; ++a) {
    if (along[a] != 0) end = std::min(end, ((along[a] > 0) - from[a]) / along[a]);
  }
  const auto crossed = [&](double t) {
    return (interpolate(corners, from + along * t) >= 0) != side;
  };
  constexpr int steps = 16, halvings = 50;
  for (int step = 1; step <= steps; ++step) {
    double high = end * step / steps;
    if (!crossed(high)) continue;
    double low = end * (step - 1) / steps;
    for (int i = 0; i < halvings; ++i)
      (crossed(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    return high;
  }
  return std::nullopt;
}

}  // namespace

Vec3 point_inside(const CellTriangles& triangles, int n, const std::array<double, 8>& g) {
  const CellCorners<3> corners{g};
  const Vec3 middle = middle_about(triangles, 12 + n, g);
  const bool side = interpolate(corners, middle) >= 0;
  const Vec3 gradient = geometric_gradient(corners, middle);
  if (gradient.length2() > 0) {
    // A step of length 2 leaves the cube from any point inside.
    const Vec3 along = gradient * ((side ? -2 : 2) / gradient.length());
    if (const auto t = distance_to_isosurface(corners, middle, along)) return middle + along * *t;
  }
  // Lines towards the corners on the other side always hit the isosurface.
  Vec3 nearest = middle;
  double shortest = 2;
  for (int corner = 0; corner < 8; ++corner) {
    if ((g[corner] >= 0) == side) continue;
    const Vec3 along = Vec3(corner & 1, (corner >> 1) & 1, corner >> 2) - middle;
    const auto t = distance_to_isosurface(corners, middle, along);
    if (!t || *t * along.length() >= shortest) continue;
    shortest = *t * along.length();
    nearest = middle + along * *t;
  }
  return nearest;
}

}  // namespace leaflight
