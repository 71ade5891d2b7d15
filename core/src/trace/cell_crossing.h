// SPDX-License-Identifier: GPL-3.0-or-later
// Inline, because a ray spends most of its time here.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "field/field.h"

namespace leaflight {

// The polynomial h - c along a segment through one cell: sum_i coefficient[i] * s^i, s in [0,1].
using SegmentPolynomial = std::array<double, 4>;

// Returns the polynomial from a point along a step.
template <int D>
SegmentPolynomial along_step(const CellCorners<D>& corners, double isovalue, const Vec<D>& from,
                             const Vec<D>& step) {
  // Interpolate along the edges in x, then in y and z.
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
  const auto low = face(0);
  if constexpr (D == 2) {
    return {low[0], low[1], low[2], 0};
  } else {
    const auto high = face(4);
    const double d0 = high[0] - low[0], d1 = high[1] - low[1], d2 = high[2] - low[2];
    return {low[0] + d0 * from.z, low[1] + d1 * from.z + d0 * step.z,
            low[2] + d2 * from.z + d1 * step.z, d2 * step.z};
  }
}

template <int D>
SegmentPolynomial along_segment(const CellCorners<D>& corners, double isovalue, const Vec<D>& from,
                                const Vec<D>& to) {
  return along_step<D>(corners, isovalue, from, to - from);
}

inline double evaluate(const SegmentPolynomial& p, double s) {
  return p[0] + s * (p[1] + s * (p[2] + s * p[3]));
}

// An interval with exactly one change of side. The polynomial is on its starting side at `low` and
// on the other side at `high`.
struct Bracket {
  double low, high;
};

// Returns the first interval in [0,1] in which the polynomial leaves its starting side, or nothing.
// `above`: the starting side is p >= 0. It is not taken from p(0): it was decided once, on the
// shared face or by the isosurface where the ray starts. So two cells never disagree.
inline std::optional<Bracket> first_bracket(const SegmentPolynomial& p, bool above) {
  const auto is_above = [](double g) { return g >= 0; };
  // Bernstein coefficients bound the polynomial. No sign change among them means no root; exactly
  // one change means exactly one root.
  const bool b1 = is_above(p[0] + p[1] / 3);
  const bool b2 = is_above(p[0] + (2 * p[1] + p[2]) / 3);
  const bool b3 = is_above(p[0] + p[1] + p[2] + p[3]);
  if (b1 == above && b2 == above && b3 == above) return std::nullopt;
  if ((b1 != above) + (b2 != b1) + (b3 != b2) == 1) return Bracket{0, 1};
  // Split at critical points: the roots in (0,1) of a + b s + c s^2, ascending, without
  // cancellation.
  const double a = p[1], b = 2 * p[2], c = 3 * p[3];
  const double discriminant = b * b - 4 * a * c;
  double low = 0;
  if (discriminant >= 0) {
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    // Division by zero gives an infinity or NaN, neither of which lies in (0,1).
    double first = a / q, second = q / c;
    if (first > second) std::swap(first, second);
    for (const double critical : {first, second}) {
      if (!(critical > low && critical < 1)) continue;
      if (is_above(evaluate(p, critical)) != above) return Bracket{low, critical};
      low = critical;
    }
  }
  if (b3 != above) return Bracket{low, 1};
  return std::nullopt;
}

// Finds the change of side in a bracket, by Newton steps that stay inside it.
inline double root_in(const SegmentPolynomial& p, Bracket bracket, bool above) {
  auto& [low, high] = bracket;
  double s = 0.5 * (low + high);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double value = evaluate(p, s);
    ((value >= 0) == above ? low : high) = s;
    const double slope = p[1] + s * (2 * p[2] + s * 3 * p[3]);
    // A zero or tiny slope gives an infinite or NaN step, which fails the bracket test.
    double next = s - value / slope;
    const bool newton = next > low && next < high;
    if (!newton) next = 0.5 * (low + high);
    if (next <= low || next >= high) break;  // adjacent numbers
    if (newton && std::abs(next - s) <= std::numeric_limits<double>::epsilon() * s) return next;
    s = next;
  }
  return high;
}

// Returns the first s in [0,1] at which the polynomial leaves its side, or nothing.
inline std::optional<double> first_crossing(const SegmentPolynomial& p, bool above) {
  const auto bracket = first_bracket(p, above);
  if (!bracket) return std::nullopt;
  return root_in(p, *bracket, above);
}

}  // namespace leaflight
