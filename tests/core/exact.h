// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "field/field.h"

namespace leaflight::test {

// Number type of the exact solution. It has 113 bits and corners have 24, so its rounding is
// negligible.
using Quad = __float128;

// The polynomial h - c along a segment, sum_i coefficient[i] * s^i.
using ExactPolynomial = std::array<Quad, 4>;

inline Quad magnitude(Quad x) { return x < 0 ? -x : x; }

inline Quad root_of(Quad x) {
  Quad root = std::sqrt(static_cast<double>(x));
  for (int i = 0; i < 3 && root > 0; ++i) root = (root + x / root) / 2;
  return root;
}

inline Quad value(const ExactPolynomial& p, Quad s) {
  return p[0] + s * (p[1] + s * (p[2] + s * p[3]));
}

template <int D>
using ExactPoint = std::array<Quad, static_cast<std::size_t>(D)>;

template <int D>
ExactPoint<D> exact_point(const Vec<D>& v) {
  ExactPoint<D> p;
  for (int a = 0; a < D; ++a) p[a] = v[a];
  return p;
}

// Returns the polynomial between two points of a cell, by linear interpolation along one axis after
// another.
template <int D>
ExactPolynomial exact_polynomial(const CellCorners<D>& corners, double c, const ExactPoint<D>& from,
                                 const ExactPoint<D>& to) {
  std::array<ExactPolynomial, 1 << D> p{};
  for (int k = 0; k < (1 << D); ++k) p[k][0] = static_cast<Quad>(corners.h[k]) - c;
  for (int a = 0; a < D; ++a) {
    const Quad step = to[a] - from[a];
    for (int k = 0; k < 1 << (D - 1 - a); ++k) {
      const ExactPolynomial low = p[2 * k], high = p[2 * k + 1];
      for (int i = 0; i < 4; ++i) {
        p[k][i] = low[i] + (high[i] - low[i]) * from[a];
        if (i > 0) p[k][i] += (high[i - 1] - low[i - 1]) * step;
      }
    }
  }
  return p[0];
}

// Returns 0, 1 and the critical points between them, so that p is monotone between neighbors.
inline std::vector<Quad> monotone_knots(const ExactPolynomial& p) {
  std::vector<Quad> knots{0};
  const auto add = [&](Quad s) {
    if (s > 0 && s < 1) knots.push_back(s);
  };
  const Quad a = p[1], b = 2 * p[2], c = 3 * p[3], discriminant = b * b - 4 * a * c;
  if (discriminant >= 0) {
    const Quad q = -(b + (b < 0 ? -1 : 1) * root_of(discriminant)) / 2;
    if (q != 0) add(a / q);
    if (c != 0) add(q / c);
  }
  knots.push_back(1);
  std::sort(knots.begin(), knots.end());
  return knots;
}

// Bounds on the first change of side. Values equal to the isovalue count as above. Values within
// the tolerance of the isovalue may be on either side, because of rounding.
struct ExactCrossing {
  static constexpr double never = std::numeric_limits<double>::infinity();

  double latest = never;    // from here on, the other side has certainly been reached
  double earliest = never;  // before, the starting side has certainly not been left

  bool required() const { return latest < never; }
  bool possible() const { return earliest < never; }
  bool tie() const { return possible() && !required(); }
};

// The search for the first change of side, given the heights at ascending positions.
class CrossingSearch {
 public:
  explicit CrossingSearch(bool above) : above_(above) {}

  // Adds the height at the next position along the ray. Returns true when the search is over.
  bool add(double place, Quad height, Quad tolerance) {
    const bool clear = tolerance == 0 || magnitude(height) > tolerance;
    const bool same = (height >= 0) == above_;
    if ((!clear || !same) && !crossing_.possible()) crossing_.earliest = last_;
    if (clear && !same) crossing_.latest = place;
    last_ = place;
    return crossing_.required();
  }
  const ExactCrossing& crossing() const { return crossing_; }

 private:
  bool above_;
  double last_ = 0;
  ExactCrossing crossing_;
};

}  // namespace leaflight::test
