// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/isosurface_ray.h"

#include <cmath>

#include "trace/brick_children.h"
#include "trace/cell_crossing.h"

namespace leaflight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The side of the isosurface on which the ray runs. Cells pass it on, so that the value on a shared
// face is compared only once.
enum class State { below, above, unknown };

State state_of(bool above) { return above ? State::above : State::below; }

// Visits the cells that the isosurface may cross, in the order of the ray. Walks over the children
// of a brick (Amanatides and Woo 1987) for each level of the field's bounds. It ends when no such
// cell lies ahead.
template <int D>
class Traversal {
 public:
  Traversal(const Field<D>& field, const IsosurfaceRay<D>& ray)
      : field_(field), bounds_(field.cell_bounds()), ray_(ray) {
    std::ptrdiff_t stride = 1;
    for (int a = 0; a < D; stride *= field.dims[a], ++a) {
      const double reciprocal = 1 / ray.direction[a];
      moves_[a] = std::isfinite(reciprocal);  // false for zero and denormal components
      inverse_[a] = moves_[a] ? reciprocal : 0;
      forward_[a] = ray.direction[a] > 0;
      for (int i = 0; i < (1 << D); ++i) corner_[i] += (i >> a & 1) * stride;
    }
  }

  // True if there is a hit, which hit() returns unless `any` is set.
  template <bool any>
  bool run() {
    if (!(field_.min < ray_.isovalue && ray_.isovalue <= field_.max) || !enter()) return false;
    limits_ = bounds_.limits(ray_.isovalue);
    return walk<any, top>(t_end_);
  }
  const IsosurfaceHit<D>& hit() const { return hit_; }

 private:
  static constexpr int log2_side = CellBounds<D>::log2_side, side = 1 << log2_side;
  static constexpr int top = CellBounds<D>::levels;

  // Returns the distance to a plane, or infinity if the ray does not move along the axis.
  double distance_to(int axis, double plane) const {
    return moves_[axis] ? (plane - ray_.position[axis]) * inverse_[axis] : infinity;
  }

  bool enter() {
    double t_in = 0;
    t_end_ = ray_.t_max;
    int axis_in = -1;
    for (int a = 0; a < D; ++a) {
      const double last = field_.dims[a] - 1;
      if (!moves_[a]) {
        if (!ray_.starts_on_isosurface && !(ray_.position[a] >= 0 && ray_.position[a] <= last)) {
          return false;
        }
        continue;
      }
      const double near = distance_to(a, forward_[a] ? 0 : last);
      if (near > t_in) t_in = near, axis_in = a;
      t_end_ = std::min(t_end_, distance_to(a, forward_[a] ? last : 0));
    }
    if (ray_.starts_on_isosurface) {
      cell_ = ray_.origin.cell;
      state_ = state_of(ray_.starts_above);
      at_start_ = true;
      read_ahead();
      return true;
    }
    if (!(t_in <= t_end_)) return false;
    t_ = t_in;
    for (int a = 0; a < D; ++a) {
      const int last = field_.dims[a] - 2;
      cell_[a] = a == axis_in ? (forward_[a] ? 0 : last) : cell_at(a, t_, 0, last);
    }
    return true;
  }

  // Prefetches bounds while the walk descends to the starting cell.
  void read_ahead() const {
    Index<D> brick = cell_;
    for (int level = 0; level < top; ++level) {
      for (int a = 0; a < D; ++a) brick[a] >>= log2_side;
      const std::size_t b = linear_number<D>(brick, bounds_.dims[level]);
      __builtin_prefetch(&bounds_.slabs[level][b]);
      const std::uint8_t* bytes =
          level == 0 ? bounds_.cells[b].steps.data() : bounds_.bricks[level - 1][b].low.data();
      __builtin_prefetch(bytes);
      __builtin_prefetch(bytes + 64);
    }
    if (bounds_.is_exact) return;
    const std::size_t first = field_.offset(cell_);
    for (int i = 0; i < (1 << D); i += 2) {
      __builtin_prefetch(address_of(field_.values, first + corner_[i]));
    }
  }

  // Returns the cell along an axis at t, within [low, high].
  int cell_at(int axis, double t, int low, int high) const {
    const double x = ray_.position[axis] + t * ray_.direction[axis];
    return std::clamp(static_cast<int>(x), low, high);
  }

  // Clips the ray's segment in the brick at `low` to the slab between its two planes. Moves t and
  // the cell to the entry, by whole cells, and `end` to the exit. Returns `segment` if part of the
  // segment is left, `nothing` if not, and `hit` if the side there contradicts the known side.
  enum class Rest { segment, nothing, hit };
  Rest clip(const typename CellBounds<D>::Slab& slab, const Index<D>& low, int size, double& end) {
    // h - c minus the plane is offset - t slope.
    double offset = ray_.isovalue, slope = 0;
    for (int a = 0; a < D; ++a) {
      offset -= slab.gradient[a] * ray_.position[a];
      slope += slab.gradient[a] * ray_.direction[a];
    }
    const double inverse = 1 / slope;
    double in = (offset - slab.high) * inverse, out = (offset - slab.low) * inverse;
    if (in > out) std::swap(in, out);
    const bool is_outside = out < t_ || in > end;
    if ((is_outside || in > t_) && !at_start_) {
      if (!is_judged_ && judge(offset - t_ * slope < slab.low, true)) return Rest::hit;
      if (!is_outside) {
        for (int a = 0; a < D; ++a) {
          cell_[a] = cell_at(a, in, low[a], std::min(low[a] + size, field_.dims[a] - 1) - 1);
          if (moves_[a]) t_ = std::max(t_, distance_to(a, cell_[a] + !forward_[a]));
        }
      }
    }
    end = std::min(end, out);
    return is_outside ? Rest::nothing : Rest::segment;
  }

  // Walks over the children of the current cell's brick of a level, or over all topmost bricks, up
  // to t = end. Returns true at a hit.
  template <bool any, int level>
  bool walk(double end) {
    using Number = Children<D, level == 0 ? CellBounds<D>::row : CellBounds<D>::side>;
    constexpr int shift = log2_side * level;  // log2 of a child's width in cells
    Index<D> first{}, child;
    ChildSet crossed, above;
    int number = 0;
    if constexpr (level < top) {
      Index<D> brick, low;
      for (int a = 0; a < D; ++a) {
        brick[a] = cell_[a] >> (shift + log2_side);
        first[a] = brick[a] << log2_side;
        low[a] = first[a] << shift;
      }
      const std::size_t b = linear_number<D>(brick, bounds_.dims[level]);
      const auto& slab = bounds_.slabs[level][b];
      if (slab.high < std::numeric_limits<float>::infinity()) {
        const Rest rest = clip(slab, low, side << shift, end);
        if (rest == Rest::hit && !any) hit_ = {t_, {cell_, local(t_)}, state_ == State::above};
        if (rest != Rest::segment) return rest == Rest::hit;
      }
      if constexpr (level == 0) {
        crossed = crossed_cells(bounds_, limits_, b, field_.masked, above);
        brick_ = b;
      } else {
        crossed = crossed_bricks(bounds_, limits_, level, b, above);
      }
      for (int a = 0; a < D; ++a) {
        child[a] = (cell_[a] >> shift) - first[a];
        number += child[a] * Number::stride(a);
        crossed = crossed & Number::ahead[a][forward_[a]][child[a]];
      }
      if (crossed.empty() && is_judged_) return false;
    } else {
      for (int a = 0; a < D; ++a) child[a] = cell_[a] >> shift;
    }
    double plane[D], t_plane[D];
    for (int a = 0; a < D; ++a) {
      plane[a] = (first[a] + child[a] + forward_[a]) << shift;
      t_plane[a] = distance_to(a, plane[a]);
    }
    bool is_cell_known = true;
    const auto find_cell = [&] {
      if (is_cell_known) return;
      for (int a = 0; a < D; ++a) {
        const int low = (first[a] + child[a]) << shift;
        const int high = std::min(low + (1 << shift), field_.dims[a] - 1) - 1;
        cell_[a] = level > 0 ? cell_at(a, t_, low, high) : low;
      }
    };
    for (;;) {
      int axis = 0;
      for (int a = 1; a < D; ++a) {
        if (t_plane[a] < t_plane[axis]) axis = a;
      }
      const double leave = t_plane[axis];
      if (level == top || crossed.holds(number)) {
        find_cell();
        if constexpr (level == 0) {
          is_judged_ = false;
          if (cross_cell<any>(number, leave)) return true;
        } else {
          if (walk<any, level - 1>(std::min(leave, end))) return true;
        }
      } else if (!is_judged_ && !at_start_) {
        // A region that the ray only touches, at an edge or corner, does not decide the side.
        if (judge(above.holds(number), leave > t_)) {
          find_cell();
          if (!any) hit_ = {t_, {cell_, local(t_)}, state_ == State::above};
          return true;
        }
      }
      t_ = std::max(t_, leave);
      at_start_ = false;
      if (!(t_ < end)) return false;
      is_cell_known = false;
      child[axis] += forward_[axis] ? 1 : -1;
      if constexpr (level < top) {
        if (static_cast<unsigned>(child[axis]) >= side) return false;
        number += forward_[axis] ? Number::stride(axis) : -Number::stride(axis);
        crossed = crossed & Number::ahead[axis][forward_[axis]][child[axis]];
        if (crossed.empty() && is_judged_) return false;
      }
      plane[axis] += forward_[axis] ? 1 << shift : -(1 << shift);
      t_plane[axis] = (plane[axis] - ray_.position[axis]) * inverse_[axis];
    }
  }

  // Updates the side in a region without a crossing. Returns true if rounding contradicts the side
  // on the face: then the crossing is on that face.
  bool judge(bool above, bool is_entered) {
    const State region = state_of(above);
    if (state_ != State::unknown && state_ != region) return is_entered;
    state_ = region;
    is_judged_ = true;
    return false;
  }

  Vec<D> local(double t) const {
    Vec<D> u;
    for (int a = 0; a < D; ++a) {
      u[a] = std::clamp(ray_.position[a] + t * ray_.direction[a] - cell_[a], 0.0, 1.0);
    }
    return u;
  }

  // True if h - c may be a zero after the rounding errors of along_step().
  bool is_rounding(double difference, const CellCorners<D>& corners) const {
    double size = 0;
    for (const double h : corners.h) size = std::max(size, std::abs(h - ray_.isovalue));
    return std::abs(difference) <= 16 * std::numeric_limits<double>::epsilon() * size;
  }

  // Returns the corners of the current cell. `number`: of its lowest voxel in the brick.
  CellCorners<D> corners_of(int number) const {
    CellCorners<D> corners;
    if (bounds_.is_exact && !field_.masked) {
      using Number = Children<D, CellBounds<D>::row>;
      const std::uint8_t* steps = bounds_.cells[brick_].steps.data() + number;
      for (int i = 0; i < (1 << D); ++i) {
        int offset = 0;
        for (int a = 0; a < D; ++a) offset += (i >> a & 1) * Number::stride(a);
        corners.h[i] = bounds_.min + steps[offset];
      }
      return corners;
    }
    const std::size_t first = field_.offset(cell_);
    std::visit(
        [&](const auto* values) {
          for (int i = 0; i < (1 << D); ++i) corners.h[i] = values[first + corner_[i]];
        },
        field_.values);
    return corners;
  }

  template <bool any>
  bool cross_cell(int number, double leave) {
    const CellCorners<D> corners = corners_of(number);
    int above_count = 0;
    for (const double h : corners.h) above_count += h >= ray_.isovalue;
    if (field_.masked) {
      for (const double h : corners.h) {
        if (std::isnan(h)) {
          state_ = State::unknown;
          return false;
        }
      }
    }
    if (above_count == 0 || above_count == (1 << D)) {
      // A ray that starts on its isosurface has a given side in its first cell.
      if (at_start_) return false;
      const bool is_hit = judge(above_count != 0, leave > t_);
      if (is_hit && !any) hit_ = {t_, {cell_, local(t_)}, state_ == State::above};
      return is_hit;
    }
    const double t_out = std::min(ray_.t_max, leave);
    if (!(t_out > t_)) return false;
    const Vec<D> from = at_start_ ? ray_.origin.local : local(t_);
    const Vec<D> to = local(t_out);
    // A ray that starts on its isosurface starts at a root. Removing the root prevents
    // self-intersection. The direction gives the slope, because a short difference of ends would
    // lose it to rounding.
    const bool starts_here = ray_.starts_on_isosurface && t_ == 0;
    const Vec<D> step = starts_here ? ray_.direction * t_out : to - from;
    SegmentPolynomial p = along_step<D>(corners, ray_.isovalue, from, step);
    if (starts_here) p[0] = 0;
    if (state_ == State::unknown) state_ = state_of(p[0] >= 0);
    const bool above = state_ == State::above;
    // The same holds in the next cells of a ray that grazes its isosurface.
    if (ray_.starts_on_isosurface && (p[0] >= 0) != above && is_rounding(p[0], corners)) p[0] = 0;
    const auto bracket = first_bracket(p, above);
    if (!bracket) return false;
    if (!any) {
      const double s = root_in(p, *bracket, above);
      hit_ = {t_ + s * (t_out - t_), {cell_, from + (to - from) * s}, above};
    }
    return true;
  }

  const Field<D>& field_;
  const CellBounds<D>& bounds_;
  const IsosurfaceRay<D>& ray_;
  double inverse_[D];
  bool moves_[D];
  int forward_[D];
  std::array<std::ptrdiff_t, 1 << D> corner_{};  // offsets of a cell's voxels from its lowest
  typename CellBounds<D>::Limits limits_;
  Index<D> cell_;
  std::size_t brick_ = 0;  // of cells
  double t_ = 0, t_end_;
  State state_ = State::unknown;
  bool at_start_ = false;
  bool is_judged_ = false;  // true if the side of the current region without a crossing is known
  IsosurfaceHit<D> hit_;
};

}  // namespace

template <int D>
std::optional<IsosurfaceHit<D>> intersect(const Field<D>& field, const IsosurfaceRay<D>& ray) {
  Traversal<D> traversal(field, ray);
  if (!traversal.template run<false>()) return std::nullopt;
  return traversal.hit();
}

template <int D>
bool occluded(const Field<D>& field, const IsosurfaceRay<D>& ray) {
  return Traversal<D>(field, ray).template run<true>();
}

template std::optional<IsosurfaceHit<2>> intersect<2>(const Field<2>&, const IsosurfaceRay<2>&);
template std::optional<IsosurfaceHit<3>> intersect<3>(const Field<3>&, const IsosurfaceRay<3>&);
template bool occluded<2>(const Field<2>&, const IsosurfaceRay<2>&);
template bool occluded<3>(const Field<3>&, const IsosurfaceRay<3>&);

}  // namespace leaflight
