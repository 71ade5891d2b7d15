// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/project.h"

#include <algorithm>
#include <cmath>

#include "field/given_point.h"

namespace leaflight {

namespace {

// Between where a function is on one side of 0 and where it is on the other, the place next to its
// change of sign, on the far side: false position with the Illinois rule (Dowell and Jarratt 1971).
template <class Value>
double change_of_sign(const Value& value, double near, double at_near, double far, double at_far) {
  constexpr double precise = 1e-14;
  constexpr int most_steps = 60;
  const bool below = at_near < 0;
  int repeated = 0;  // steps that moved the near end alone, or less than 0 the far one
  for (int i = 0; i < most_steps && far - near > precise; ++i) {
    double middle = (near * at_far - far * at_near) / (at_far - at_near);
    if (!(middle > near && middle < far)) middle = 0.5 * (near + far);
    const double there = value(middle);
    if ((there < 0) == below) {
      near = middle;
      at_near = there;
      repeated = std::max(repeated, 0) + 1;
      if (repeated > 1) at_far *= 0.5;
    } else {
      far = middle;
      at_far = there;
      repeated = std::min(repeated, 0) - 1;
      if (repeated < -1) at_near *= 0.5;
    }
  }
  return far;
}

}  // namespace

template <int D>
Vec<D> project_to_leaf(const Field<D>& field, const Vec<D>& world, double isovalue) {
  const Vec<D> start = field.world_to_index.point(world);
  if (!holds_given(field, start)) return world;
  const auto value = [&](const Vec<D>& p) {
    const CellPoint<D> point = locate(field, p);
    return interpolate(load_corners(field, point.cell), point.local) - isovalue;
  };
  const CellPoint<D> point = locate(field, start);
  Vec<D> along = geometric_gradient(load_corners(field, point.cell), point.local);
  const double here = value(start);
  if (!(along.length() > 0) || here == 0 || std::isnan(here)) return world;
  along *= (here < 0 ? 1 : -1) / along.length();
  constexpr double step = 1.0 / 16, reach = 2;
  const auto value_along = [&](double t) { return value(start + along * t); };
  double low = 0, at_low = here;
  for (double high = step; high <= reach; high += step) {
    const double at_high = value_along(high);
    if (std::isnan(at_high)) break;
    if ((at_high < 0) != (here < 0)) {
      const double t = change_of_sign(value_along, low, at_low, high, at_high);
      return field.index_to_world.point(locate(field, start + along * t).index_position());
    }
    low = high;
    at_low = at_high;
  }
  return world;
}

template Vec<2> project_to_leaf<2>(const Field<2>&, const Vec<2>&, double);
template Vec<3> project_to_leaf<3>(const Field<3>&, const Vec<3>&, double);

}  // namespace leaflight
