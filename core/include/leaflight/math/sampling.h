// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "leaflight/math/vector.h"

namespace leaflight {

inline constexpr double pi = 3.14159265358979323846;

// The integral of the cosine over the hemisphere (thesis Eq. 3.3) and the hemicircle (Eq. 3.4).
template <int D>
inline constexpr double projected_hemisphere = D == 3 ? pi : 2.0;

// Direction about the unit normal n with density cos / projected_hemisphere; u in [0,1)^2, of which
// the plane needs only the first.
template <int D>
Vec<D> sample_cosine_hemisphere(const Vec<D>& n, const std::array<double, 2>& u);

// sin(theta) = 2u - 1 (thesis Eq. 3.8, corrected).
template <>
inline Vec<2> sample_cosine_hemisphere<2>(const Vec<2>& n, const std::array<double, 2>& u) {
  const double sine = 2 * u[0] - 1;
  return n * std::sqrt(std::max(0.0, 1 - sine * sine)) + Vec<2>(-n.y, n.x) * sine;
}

// The frame is branch-free (Duff et al. 2017).
template <>
inline Vec<3> sample_cosine_hemisphere<3>(const Vec<3>& n, const std::array<double, 2>& u) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  const Vec3 tangent(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  const Vec3 bitangent(b, sign + n.y * n.y * a, -n.y);
  const double r = std::sqrt(u[0]);
  const double phi = 2.0 * pi * u[1];
  return tangent * (r * std::cos(phi)) + bitangent * (r * std::sin(phi)) +
         n * std::sqrt(std::max(0.0, 1.0 - u[0]));
}

}  // namespace leaflight
