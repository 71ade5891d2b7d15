// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/greatest_value.h"

#include <cmath>
#include <limits>

#include "trace/cell_crossing.h"

namespace leaflight {
namespace {

// Returns the maximum of the polynomial over [0,1], or `least` if that is greater.
double greatest_of(const SegmentPolynomial& p, double least) {
  const double end = p[0] + p[1] + p[2] + p[3];
  double most = std::max({least, p[0], end});
  // Bernstein coefficients bound the polynomial.
  if (std::max(p[0] + p[1] / 3, p[0] + (2 * p[1] + p[2]) / 3) <= most) return most;
  // Test the roots of the derivative a + b s + c s^2, without cancellation.
  const double a = p[1], b = 2 * p[2], c = 3 * p[3], discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return most;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  for (const double s : {a / q, q / c}) {
    if (s > 0 && s < 1) most = std::max(most, evaluate(p, s));
  }
  return most;
}

// Finds the greatest value times `sign`. Walks over the children of a brick (Amanatides and Woo
// 1987) for each level of the field's bounds.
template <int D, int sign>
class Walk {
 public:
  Walk(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction, double least)
      : field_(field),
        bounds_(field.cell_bounds()),
        position_(position),
        direction_(direction),
        greatest_(least),
        steps_(bounds_.steps_at(sign * least)) {
    for (int a = 0; a < D; ++a) {
      const double reciprocal = 1 / direction[a];
      moves_[a] = std::isfinite(reciprocal);
      inverse_[a] = moves_[a] ? reciprocal : 0;
    }
  }

  double run(double t_max) {
    double t = 0, end = t_max;
    for (int a = 0; a < D; ++a) {
      const double last = field_.dims[a] - 1;
      if (!moves_[a]) {
        if (!(position_[a] >= 0 && position_[a] <= last)) return greatest_;
        continue;
      }
      const double low = -position_[a] * inverse_[a], high = (last - position_[a]) * inverse_[a];
      t = std::max(t, std::min(low, high));
      end = std::min(end, std::max(low, high));
    }
    if (!(t <= end)) return greatest_;
    begin_with_samples(t, end);
    visit<top>({}, t, end);
    return greatest_;
  }

 private:
  // Number of samples on the segment before the traversal; 8 or 16 are not faster (walls of the
  // bump box and Colin27).
  static constexpr int samples = 4;
  static constexpr int log2_side = CellBounds<D>::log2_side, side = CellBounds<D>::side;
  static constexpr int top = CellBounds<D>::levels;

  // Samples the segment first, because a greater known value skips more bricks.
  void begin_with_samples(double t, double end) {
    for (int i = 0; i < samples; ++i) {
      const double h =
          value_at(field_, position_ + direction_ * (t + (i + 0.5) / samples * (end - t)));
      if (sign * h > greatest_) greatest_ = sign * h;
    }
    steps_ = bounds_.steps_at(sign * greatest_);
  }

  // True if a child may contain a greater value. Bounds are rounded down.
  bool may_be_greater(const typename CellBounds<D>::Bricks& children, int number) const {
    if (sign < 0) return children.low[number] < steps_;
    return children.high[number] + (bounds_.is_exact ? 0 : 1) > steps_;
  }

  // Visits the children of a brick that the segment crosses from t to end. Level 0 has cells.
  template <int level>
  void visit(const Index<D>& brick, double t, double end) {
    constexpr int shift = log2_side * level;  // log2 of a child's width in cells
    const typename CellBounds<D>::Bricks* children = nullptr;
    if constexpr (level > 0 && level < top) {
      children = &bounds_.bricks[level - 1][linear_number<D>(brick, bounds_.dims[level])];
    }
    Index<D> child, low, high;
    double leave[D];
    for (int a = 0; a < D; ++a) {
      low[a] = level < top ? brick[a] << log2_side : 0;
      high[a] = (field_.dims[a] - 2) >> shift;
      if (level < top) high[a] = std::min(high[a], low[a] + side - 1);
      const double x = position_[a] + t * direction_[a];
      child[a] = std::clamp(static_cast<int>(x) >> shift, low[a], high[a]);
      leave[a] = plane(a, child[a], shift);
    }
    for (;;) {
      int axis = 0;
      for (int a = 1; a < D; ++a) {
        if (leave[a] < leave[axis]) axis = a;
      }
      const double out = std::min(leave[axis], end);
      if constexpr (level == 0) {
        cell(child, t, out);
      } else {
        int number = 0;
        for (int a = D - 1; a >= 0; --a) number = number * side + (child[a] - low[a]);
        if (level == top || may_be_greater(*children, number)) {
          visit<level - 1>(child, t, out);
        }
      }
      if (!(out < end)) return;
      t = std::max(t, out);
      child[axis] += direction_[axis] > 0 ? 1 : -1;
      if (child[axis] < low[axis] || child[axis] > high[axis]) return;
      leave[axis] = plane(axis, child[axis], shift);
    }
  }

  // Returns where the segment leaves a child along an axis.
  double plane(int axis, int child, int shift) const {
    if (!moves_[axis]) return std::numeric_limits<double>::infinity();
    return (((child + (direction_[axis] > 0)) << shift) - position_[axis]) * inverse_[axis];
  }

  void cell(const Index<D>& cell, double t, double out) {
    CellCorners<D> corners = load_corners(field_, cell);
    double most = -std::numeric_limits<double>::infinity();
    for (double& h : corners.h) {
      if (std::isnan(h)) return;
      h *= sign;
      most = std::max(most, h);
    }
    if (!(most > greatest_)) return;
    Vec<D> from, to;
    for (int a = 0; a < D; ++a) {
      from[a] = std::clamp(position_[a] + t * direction_[a] - cell[a], 0.0, 1.0);
      to[a] = std::clamp(position_[a] + out * direction_[a] - cell[a], 0.0, 1.0);
    }
    const double found = greatest_of(along_segment<D>(corners, 0, from, to), greatest_);
    if (!(found > greatest_)) return;
    greatest_ = found;
    steps_ = bounds_.steps_at(sign * found);
  }

  const Field<D>& field_;
  const CellBounds<D>& bounds_;
  const Vec<D>& position_;
  const Vec<D>& direction_;
  bool moves_[D];
  double inverse_[D];
  double greatest_, steps_;  // the greatest value, and the same in steps of the bounds
};

}  // namespace

template <int D>
double greatest_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                      double t_max, double least) {
  // No isosurface crosses a constant field.
  if (!(field.max > least && field.min < field.max)) return least;
  return Walk<D, 1>(field, position, direction, least).run(t_max);
}

template <int D>
double least_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                   double t_max, double most) {
  if (!(field.min < most && field.min < field.max)) return most;
  return -Walk<D, -1>(field, position, direction, -most).run(t_max);
}

template double greatest_value<2>(const Field<2>&, const Vec<2>&, const Vec<2>&, double, double);
template double greatest_value<3>(const Field<3>&, const Vec<3>&, const Vec<3>&, double, double);
template double least_value<2>(const Field<2>&, const Vec<2>&, const Vec<2>&, double, double);
template double least_value<3>(const Field<3>&, const Vec<3>&, const Vec<3>&, double, double);

}  // namespace leaflight
