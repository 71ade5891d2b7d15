// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/leaf_ray.h"

#include <cmath>

#include "leaflight/trace/cell_crossing.h"

namespace leaflight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Per axis: where the ray meets a plane, with axes along which it does not move never met.
template <int D>
struct Planes {
  Vec<D> position, inverse, never;
  std::array<int, D> forward;

  explicit Planes(const LeafRay<D>& ray) : position(ray.position) {
    for (int a = 0; a < D; ++a) {
      const double d = ray.direction[a];
      const double reciprocal = 1 / d;
      const bool moves = std::isfinite(reciprocal);  // zero and denormal components do not
      inverse[a] = moves ? reciprocal : 0;
      never[a] = moves ? 0 : infinity;
      forward[a] = d > 0;
    }
  }
  double meet(int axis, double plane) const {
    return (plane - position[axis]) * inverse[axis] + never[axis];
  }
};

// What is known of the side on which the ray runs. It is carried from cell to cell: the value on a
// shared face is judged once.
enum class State { below, above, unknown };

State state_of(bool above) { return above ? State::above : State::below; }

template <int D>
class Traversal {
 public:
  Traversal(const Field<D>& field, const LeafRay<D>& ray)
      : field_(field), ray_(ray), planes_(ray) {}

  std::optional<LeafHit<D>> run() {
    if (!enter()) return std::nullopt;
    const int top = static_cast<int>(field_.pyramid.levels.size());
    int level = top;  // 0: cell, L: brick of levels[L - 1]
    for (;;) {
      if (level > 0) {
        const Interval& interval = interval_at(level);
        if (interval.crossed_by(ray_.isovalue)) {
          --level;
          continue;
        }
        const bool above = interval.min >= ray_.isovalue;
        // Only a cell knows whether the face between two sides is masked.
        if (field_.masked && state_ == state_of(!above)) {
          --level;
          continue;
        }
        while (level < top && !interval_at(level + 1).crossed_by(ray_.isovalue)) ++level;
        if (auto hit = pass(above, level)) return hit;
        if (field_.masked) state_ = State::unknown;
        if (!advance(level, exit(level))) return std::nullopt;
        continue;
      }
      const Exit leave = cell_exit();
      if (auto hit = cross_cell(leave.t)) return hit;
      const Index<D> before = cell_;
      if (!advance(0, leave)) return std::nullopt;
      for (int a = 0; a < D; ++a) {
        if ((before[a] ^ cell_[a]) >> IntervalPyramid<D>::log2_brick) level = 1;
      }
    }
  }

 private:
  bool enter() {
    if (ray_.starts_on_leaf) {
      cell_ = ray_.origin.cell;
      state_ = state_of(ray_.starts_above);
      at_start_ = true;
      t_ = 0;
      return true;
    }
    double t_in = 0, t_out = ray_.t_max;
    int axis_in = -1;
    for (int a = 0; a < D; ++a) {
      const double last = field_.dims[a] - 1;
      if (planes_.never[a] != 0) {
        if (ray_.position[a] < 0 || ray_.position[a] > last) return false;
        continue;
      }
      const double near = planes_.meet(a, planes_.forward[a] ? 0 : last);
      const double far = planes_.meet(a, planes_.forward[a] ? last : 0);
      if (near > t_in) t_in = near, axis_in = a;
      t_out = std::min(t_out, far);
    }
    if (!(t_in <= t_out)) return false;
    t_ = t_in;
    for (int a = 0; a < D; ++a) {
      const int last = field_.dims[a] - 2;
      if (a == axis_in) {
        cell_[a] = planes_.forward[a] ? 0 : last;
      } else {
        const double x = ray_.position[a] + t_ * ray_.direction[a];
        cell_[a] = std::clamp(static_cast<int>(std::floor(x)), 0, last);
      }
    }
    return true;
  }

  const Interval& interval_at(int level) const {
    Index<D> brick;
    for (int a = 0; a < D; ++a) brick[a] = cell_[a] >> (IntervalPyramid<D>::log2_brick * level);
    return field_.pyramid.levels[level - 1].at(brick);
  }

  // The brick of the given level around the present cell, along one axis: [low, high).
  int low(int axis, int level) const {
    const int shift = IntervalPyramid<D>::log2_brick * level;
    return (cell_[axis] >> shift) << shift;
  }
  int high(int axis, int level) const {
    if (level == 0) return cell_[axis] + 1;
    const int size = 1 << (IntervalPyramid<D>::log2_brick * level);
    return std::min(low(axis, level) + size, field_.dims[axis] - 1);
  }

  struct Exit {
    double t;
    int axis;
  };
  Exit exit(int level) const {
    Exit first{infinity, 0};
    for (int a = 0; a < D; ++a) {
      const double t = planes_.meet(a, planes_.forward[a] ? high(a, level) : low(a, level));
      if (t < first.t) first = {t, a};
    }
    return first;
  }

  Exit cell_exit() const {
    Exit first{infinity, 0};
    for (int a = 0; a < D; ++a) {
      const double t = planes_.meet(a, cell_[a] + planes_.forward[a]);
      if (t < first.t) first = {t, a};
    }
    return first;
  }

  // Moves to the cell behind the brick of the given level; false at the end of domain or ray.
  bool advance(int level, const Exit& leave) {
    t_ = std::max(t_, leave.t);
    if (!(t_ < ray_.t_max)) return false;
    const int axis = leave.axis;
    const int behind = planes_.forward[axis] ? high(axis, level) : low(axis, level) - 1;
    for (int a = 0; a < D && level > 0; ++a) {
      const double x = ray_.position[a] + t_ * ray_.direction[a];
      cell_[a] = std::clamp(static_cast<int>(std::floor(x)), low(a, level), high(a, level) - 1);
    }
    cell_[axis] = behind;
    at_start_ = false;
    return cell_[axis] >= 0 && cell_[axis] <= field_.dims[axis] - 2;
  }

  Vec<D> local(double t) const {
    Vec<D> u;
    for (int a = 0; a < D; ++a) {
      u[a] = std::clamp(ray_.position[a] + t * ray_.direction[a] - cell_[a], 0.0, 1.0);
    }
    return u;
  }

  // A region without a crossing. If the side judged on the face disagrees with it by rounding, the
  // crossing is on that face; unless the ray only touches the region, at an edge or corner, which
  // judges nothing. In the cell where it starts, a ray that starts on its leaf has a side of its
  // own.
  std::optional<LeafHit<D>> pass(bool above, int level) {
    const State region = state_of(above);
    if (at_start_) return std::nullopt;
    if (state_ != State::unknown && state_ != region) {
      if (exit(level).t <= t_) return std::nullopt;
      return LeafHit<D>{t_, {cell_, local(t_)}, !above};
    }
    state_ = region;
    return std::nullopt;
  }

  // Whether h - c is what is left of a zero by the dozen roundings of along_segment().
  bool is_rounding(double difference, const CellCorners<D>& corners) const {
    double size = 0;
    for (const double h : corners.h) size = std::max(size, std::abs(h - ray_.isovalue));
    return std::abs(difference) <= 16 * std::numeric_limits<double>::epsilon() * size;
  }

  std::optional<LeafHit<D>> cross_cell(double t_exit) {
    const CellCorners<D> corners = load_corners(field_, cell_);
    int above_count = 0;
    for (const double h : corners.h) above_count += h >= ray_.isovalue;
    if (field_.masked) {
      for (const double h : corners.h) {
        if (std::isnan(h)) {
          state_ = State::unknown;
          return std::nullopt;
        }
      }
    }
    if (above_count == 0 || above_count == (1 << D)) return pass(above_count != 0, 0);
    const double t_out = std::min(ray_.t_max, t_exit);
    if (!(t_out > t_)) return std::nullopt;
    const Vec<D> from = at_start_ ? ray_.origin.local : local(t_);
    const Vec<D> to = local(t_out);
    SegmentPolynomial p = along_segment<D>(corners, ray_.isovalue, from, to);
    // A ray that starts on its leaf starts at a root: taking it out leaves no self-intersection. On
    // a short way the slope, too, would be lost in the rounding of its ends.
    if (ray_.starts_on_leaf && t_ == 0) {
      p[0] = 0;
      p[1] = geometric_gradient(corners, from).dot(ray_.direction) * t_out;
    }
    if (state_ == State::unknown) state_ = state_of(p[0] >= 0);
    const bool above = state_ == State::above;
    // So does a ray that grazes its leaf enter the next cells.
    if (ray_.starts_on_leaf && (p[0] >= 0) != above && is_rounding(p[0], corners)) p[0] = 0;
    if (const auto s = first_crossing(p, above)) {
      const double t = t_ + *s * (t_out - t_);
      return LeafHit<D>{t, {cell_, from + (to - from) * *s}, above};
    }
    return std::nullopt;
  }

  const Field<D>& field_;
  const LeafRay<D>& ray_;
  const Planes<D> planes_;
  Index<D> cell_;
  double t_ = 0;
  State state_ = State::unknown;
  bool at_start_ = false;
};

}  // namespace

template <int D>
std::optional<LeafHit<D>> intersect(const Field<D>& field, const LeafRay<D>& ray) {
  return Traversal<D>(field, ray).run();
}

template std::optional<LeafHit<2>> intersect<2>(const Field<2>&, const LeafRay<2>&);
template std::optional<LeafHit<3>> intersect<3>(const Field<3>&, const LeafRay<3>&);

}  // namespace leaflight
