// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "base/vector.h"

namespace leaflight {

inline constexpr double pi = 3.14159265358979323846;

// The integral of the cosine over the hemisphere (thesis Eq. 3.3) or the hemicircle (Eq. 3.4).
template <int D>
inline constexpr double projected_hemisphere = D == 3 ? pi : 2.0;

// The measure of all directions: 4 pi, or 2 pi in 2D.
template <int D>
inline constexpr double all_directions = D == 3 ? 4 * pi : 2 * pi;

// The measure of a disc, or in 2D a segment, of radius 1.
template <int D>
inline constexpr double unit_disc = D == 3 ? pi : 2.0;

// Returns the divisor of light at a distance: its square, or in 2D the distance.
template <int D>
double spread(double distance) {
  return D == 3 ? distance * distance : distance;
}

// Samples the unit disc uniformly.
inline Vec<2> sample_disc(const std::array<double, 2>& u) {
  const double r = std::sqrt(u[0]), phi = 2 * pi * u[1];
  return {r * std::cos(phi), r * std::sin(phi)};
}

// Returns two unit vectors perpendicular to the unit vector n and to each other, without a branch
// (Duff et al. 2017).
inline std::array<Vec3, 2> tangents(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  return {Vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          Vec3(b, sign + n.y * n.y * a, -n.y)};
}
inline std::array<Vec<2>, 1> tangents(const Vec<2>& n) { return {Vec<2>(-n.y, n.x)}; }

// Samples the disc of radius 1 perpendicular to n uniformly; in 2D a segment.
template <int D>
Vec<D> sample_facing_disc(const Vec<D>& n, const std::array<double, 2>& u) {
  const auto tangent = tangents(n);
  if constexpr (D == 2) {
    return tangent[0] * (2 * u[0] - 1);
  } else {
    const Vec<2> disc = sample_disc(u);
    return tangent[0] * disc.x + tangent[1] * disc.y;
  }
}

// Returns 1 - cosine of an angle up to 90 degrees from its sine, accurate for small angles.
inline double one_minus_cosine(double sine) {
  return sine * sine / (1 + std::sqrt(1 - sine * sine));
}

// Returns the measure of the directions within an angle of an axis, given 1 - its cosine.
template <int D>
double cone_measure(double one_minus_cosine) {
  if constexpr (D == 3) return 2 * pi * one_minus_cosine;
  return 4 * std::asin(std::sqrt(0.5 * one_minus_cosine));
}

// Samples directions within an angle of the unit axis uniformly. The parameter 1 - cosine keeps
// narrow cones accurate.
template <int D>
Vec<D> sample_cone(const Vec<D>& axis, double one_minus_cosine, const std::array<double, 2>& u) {
  const auto tangent = tangents(axis);
  if constexpr (D == 2) {
    const double angle = (u[0] - 0.5) * cone_measure<D>(one_minus_cosine);
    return axis * std::cos(angle) + tangent[0] * std::sin(angle);
  } else {
    const double less = u[0] * one_minus_cosine;  // 1 - the cosine of the direction
    const double sine = std::sqrt(less * (2 - less)), phi = 2 * pi * u[1];
    return axis * (1 - less) + tangent[0] * (sine * std::cos(phi)) +
           tangent[1] * (sine * std::sin(phi));
  }
}

// Samples directions about the unit normal n with density cos / projected_hemisphere. u: in
// [0,1)^2; 2D ignores the second number.
template <int D>
Vec<D> sample_cosine_hemisphere(const Vec<D>& n, const std::array<double, 2>& u);

// Uses sin(theta) = 2u - 1 (thesis Eq. 3.8, corrected).
template <>
inline Vec<2> sample_cosine_hemisphere<2>(const Vec<2>& n, const std::array<double, 2>& u) {
  const double sine = 2 * u[0] - 1;
  return n * std::sqrt(std::max(0.0, 1 - sine * sine)) + Vec<2>(-n.y, n.x) * sine;
}

template <>
inline Vec<3> sample_cosine_hemisphere<3>(const Vec<3>& n, const std::array<double, 2>& u) {
  const auto [tangent, bitangent] = tangents(n);
  const double r = std::sqrt(u[0]);
  const double phi = 2.0 * pi * u[1];
  return tangent * (r * std::cos(phi)) + bitangent * (r * std::sin(phi)) +
         n * std::sqrt(std::max(0.0, 1.0 - u[0]));
}

}  // namespace leaflight
