// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cell_tunnels.h"

#include <algorithm>
#include <cmath>

#include "surface/cell_polygons.h"

namespace leaflight {
namespace {

using CornerValues = std::array<double, 8>;

// Returns the corner of a face whose region contains the point (u, v) and has the given sign.
// Returns -1 if rounding leaves none. The axis of u follows that of the face, and the axis of v
// follows that of u.
int corner_of(const CornerValues& g, unsigned above, unsigned joined, int face, double u, double v,
              bool sign) {
  const int axis = face / 2, base = (face % 2) << axis;
  const int along_u = 1 << ((axis + 1) % 3), along_v = 1 << ((axis + 2) % 3);
  const auto has_sign = [&](int corner) { return (((above >> corner) & 1u) != 0) == sign; };
  int found = -1, count = 0;
  for (const int corner : {base, base | along_u, base | along_v, base | along_u | along_v}) {
    if (!has_sign(corner)) continue;
    if (found < 0) found = corner;
    ++count;
  }
  const bool alternates = count == 2 && has_sign(found ^ along_u ^ along_v);
  if (!alternates || (((joined >> face) & 1u) != 0) == sign) return found;
  // If separate, each region is on its own side of the bilinear interpolant's saddle.
  const double corner = g[base], by_u = g[base | along_u] - corner;
  const double by_v = g[base | along_v] - corner;
  const double by_both = g[base | along_u | along_v] - g[base | along_u] - by_v;
  const bool right = u * by_both * by_both > -by_v * by_both;
  const bool up = v * by_both * by_both > -by_u * by_both;
  const int nearest = base | (right ? along_u : 0) | (up ? along_v : 0);
  return has_sign(nearest) ? nearest : found;
}

class Regions {
 public:
  Regions() {
    for (int i = 0; i < 8; ++i) region_[i] = static_cast<std::uint8_t>(i);
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax(region_[a], region_[b]);
    std::replace(region_.begin(), region_.end(), std::uint8_t{high}, std::uint8_t{low});
  }
  const std::array<std::uint8_t, 8>& all() const { return region_; }

 private:
  std::array<std::uint8_t, 8> region_;
};

double value_at(const CornerValues& g, const std::array<double, 3>& x) {
  CornerValues h = g;
  for (int a = 2; a >= 0; --a) {
    for (int i = 0; i < (1 << a); ++i) h[i] += x[a] * (h[i + (1 << a)] - h[i]);
  }
  return h[0];
}

}  // namespace

// Finds the saddles of c + sum b_a x_a + sum m_a x_b x_c + t xyz (a, b, c all different).
// Let X = t x + m_x and so on, and d_a = t b_a - m_b m_c. The gradient is zero where
// Y Z = -d_x, X Z = -d_y, X Y = -d_z. Hence X = -s / d_x with s^2 = -d_x d_y d_z.
CellSaddles cell_saddles(const std::array<double, 8>& g) {
  const std::array<double, 3> b{g[1] - g[0], g[2] - g[0], g[4] - g[0]};
  const std::array<double, 3> m{g[6] - g[4] - b[1], g[5] - g[4] - b[0], g[3] - g[2] - b[0]};
  const double t = g[7] - g[6] - (g[5] - g[4]) - m[2];
  const std::array<double, 3> d{t * b[0] - m[1] * m[2], t * b[1] - m[0] * m[2],
                                t * b[2] - m[0] * m[1]};
  const double square = -d[0] * d[1] * d[2];
  CellSaddles saddles;
  if (!(square > 0)) return saddles;
  for (const double s : {std::sqrt(square), -std::sqrt(square)}) {
    std::array<double, 3>& x = saddles.point[saddles.count];
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const double scaled = -s / d[i];
      if ((scaled > 0) == (m[i] > 0)) {
        // Expand the difference of two similar numbers, so that t cancels.
        const double product =
            t * b[j] * b[k] - m[i] * (b[j] * m[j] + b[k] * m[k]) + b[i] * m[i] * m[i];
        x[i] = -product / (d[i] * m[i] - s);
      } else {
        x[i] = (scaled - m[i]) / t;
      }
      inside = inside && x[i] > 0 && x[i] < 1;
    }
    if (inside) ++saddles.count;
  }
  return saddles;
}

std::array<std::uint8_t, 8> connected_corners(const std::array<double, 8>& g, unsigned above,
                                              unsigned joined, const CellSaddles& saddles) {
  Regions regions;
  const auto is_above = [&](int corner) { return ((above >> corner) & 1u) != 0; };
  for (int corner = 0; corner < 8; ++corner) {
    for (int a = 0; a < 3; ++a) {
      const int other = corner ^ (1 << a);
      if (is_above(corner) == is_above(other)) regions.join(corner, other);
    }
  }
  const unsigned alternating = alternating_faces(above);
  for (int face = 0; face < 6; ++face) {
    if (!((alternating >> face) & 1u)) continue;
    const auto corner = face_corners(face);
    const bool first_joined = is_above(corner[0]) == (((joined >> face) & 1u) != 0);
    regions.join(corner[first_joined ? 0 : 1], corner[first_joined ? 2 : 3]);
  }
  for (int i = 0; i < saddles.count; ++i) {
    const auto& x = saddles.point[i];
    const bool sign = value_at(g, x) >= 0;
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      const double u = x[(face / 2 + 1) % 3], v = x[(face / 2 + 2) % 3];
      const int corner = corner_of(g, above, joined, face, u, v, sign);
      if (corner < 0) continue;
      if (first >= 0) regions.join(first, corner);
      first = corner;
    }
  }
  return regions.all();
}

}  // namespace leaflight
