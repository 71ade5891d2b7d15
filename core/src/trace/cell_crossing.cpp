// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/cell_crossing.h"

#include <cmath>
#include <limits>

namespace leaflight {
namespace {

bool is_above(double g) { return g >= 0; }

// The change of side in [low, high]: p is on side `above` at low and on the other at high.
double bracketed_root(const SegmentPolynomial& p, double low, double high, bool above) {
  double s = 0.5 * (low + high);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double value = evaluate(p, s);
    (is_above(value) == above ? low : high) = s;
    const double slope = p[1] + s * (2 * p[2] + s * 3 * p[3]);
    // A zero or tiny slope gives an infinite or NaN step, which fails the bracket test.
    double next = s - value / slope;
    const bool newton = next > low && next < high;
    if (!newton) next = 0.5 * (low + high);
    if (next <= low || next >= high) break;  // neighbouring numbers
    if (newton && std::abs(next - s) <= std::numeric_limits<double>::epsilon() * s) return next;
    s = next;
  }
  return high;
}

// Roots in (0,1), ascending, of a + b s + c s^2, without cancellation.
int quadratic_roots(double a, double b, double c, std::array<double, 2>& roots) {
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  // Division by zero gives an infinity or NaN, neither of which lies in (0,1).
  double first = a / q, second = q / c;
  if (first > second) std::swap(first, second);
  int n = 0;
  if (first > 0 && first < 1) roots[n++] = first;
  if (second > 0 && second < 1 && second != first) roots[n++] = second;
  return n;
}

}  // namespace

double evaluate(const SegmentPolynomial& p, double s) {
  return p[0] + s * (p[1] + s * (p[2] + s * p[3]));
}

template <>
SegmentPolynomial along_segment<2>(const CellCorners<2>& corners, double isovalue,
                                   const Vec<2>& from, const Vec<2>& to) {
  const Vec<2> step = to - from;
  // Linear along the two edges in x, then interpolated in y.
  const auto edge = [&](int i) {
    const double base = corners.h[i] - isovalue;
    const double rise = corners.h[i + 1] - corners.h[i];
    return std::array<double, 2>{base + rise * from.x, rise * step.x};
  };
  const auto low = edge(0), high = edge(2);
  const double d0 = high[0] - low[0], d1 = high[1] - low[1];
  return {low[0] + d0 * from.y, low[1] + d1 * from.y + d0 * step.y, d1 * step.y, 0};
}

template <>
SegmentPolynomial along_segment<3>(const CellCorners<3>& corners, double isovalue, const Vec3& from,
                                   const Vec3& to) {
  const Vec3 step = to - from;
  const auto edge = [&](int i) {
    const double base = corners.h[i] - isovalue;
    const double rise = corners.h[i + 1] - corners.h[i];
    return std::array<double, 2>{base + rise * from.x, rise * step.x};
  };
  const auto face = [&](int i) {
    const auto low = edge(i), high = edge(i + 2);
    const double d0 = high[0] - low[0], d1 = high[1] - low[1];
    return std::array<double, 3>{low[0] + d0 * from.y, low[1] + d1 * from.y + d0 * step.y,
                                 d1 * step.y};
  };
  const auto low = face(0), high = face(4);
  const double d0 = high[0] - low[0], d1 = high[1] - low[1], d2 = high[2] - low[2];
  return {low[0] + d0 * from.z, low[1] + d1 * from.z + d0 * step.z,
          low[2] + d2 * from.z + d1 * step.z, d2 * step.z};
}

std::optional<double> first_crossing(const SegmentPolynomial& p, bool above) {
  // Bernstein coefficients bound the polynomial: no change of sign among them, no root; exactly
  // one, exactly one root.
  const double end = p[0] + p[1] + p[2] + p[3];
  const bool b1 = is_above(p[0] + p[1] / 3);
  const bool b2 = is_above(p[0] + (2 * p[1] + p[2]) / 3);
  const bool b3 = is_above(end);
  if (b1 == above && b2 == above && b3 == above) return std::nullopt;
  const int changes = (b1 != above) + (b2 != b1) + (b3 != b2);
  if (changes == 1) return bracketed_root(p, 0, 1, above);
  std::array<double, 2> critical;
  const int n = quadratic_roots(p[1], 2 * p[2], 3 * p[3], critical);
  double low = 0;
  for (int i = 0; i < n; ++i) {
    if (is_above(evaluate(p, critical[i])) != above) {
      return bracketed_root(p, low, critical[i], above);
    }
    low = critical[i];
  }
  if (b3 != above) return bracketed_root(p, low, 1, above);
  return std::nullopt;
}

}  // namespace leaflight
