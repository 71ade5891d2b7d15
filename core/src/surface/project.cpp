// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/project.h"

#include <algorithm>
#include <cmath>

#include "field/given_point.h"
#include "field/shading_gradient.h"

namespace leaflight {

namespace {

// Finds a sign change of a function between two arguments, by false position with the Illinois rule
// (Dowell and Jarratt 1971). Returns the argument within `precise` of it, on the far side.
template <class Value>
double change_of_sign(const Value& value, double near, double at_near, double far, double at_far,
                      double precise) {
  constexpr int most_steps = 60;
  const bool below = at_near < 0;
  int repeated = 0;  // successive steps that moved only the near end; negative: only the far end
  for (int i = 0; i < most_steps && far - near > precise; ++i) {
    double middle = (near * at_far - far * at_near) / (at_far - at_near);
    if (!(middle > near && middle < far)) middle = 0.5 * (near + far);
    const double at_middle = value(middle);
    if ((at_middle < 0) == below) {
      near = middle;
      at_near = at_middle;
      repeated = std::max(repeated, 0) + 1;
      if (repeated > 1) at_far *= 0.5;
    } else {
      far = middle;
      at_far = at_middle;
      repeated = std::min(repeated, 0) - 1;
      if (repeated < -1) at_near *= 0.5;
    }
  }
  return far;
}

// Distances of a search for an isosurface along a line, in voxels.
struct Search {
  double step;     // between the points whose values are compared
  double precise;  // largest error of the place that is found
};
constexpr Search exact{1.0 / 16, 1e-14};
// For coarse meshes, whose edges are at least two voxels long.
constexpr Search quick{1.0 / 4, 1e-4};

// Returns the distance along a direction to the first crossing of the isovalue, from below or from
// above. Returns 0 if there is none within `reach` voxels. Start and direction are in index
// coordinates.
template <int D>
double first_crossing(const Field<D>& field, const Vec<D>& start, const Vec<D>& along,
                      double isovalue, bool from_below, double reach, const Search& search) {
  const auto value = [&](double t) {
    const CellPoint<D> point = locate(field, Vec<D>(start + along * t));
    return interpolate(load_corners(field, point.cell), point.local) - isovalue;
  };
  double low = 0, at_low = value(0);
  for (double high = search.step; high <= reach; high += search.step) {
    const double at_high = value(high);
    if (std::isnan(at_high)) break;
    if ((at_low < 0) == from_below && (at_high < 0) != from_below) {
      return change_of_sign(value, low, at_low, high, at_high, search.precise);
    }
    low = high;
    at_low = at_high;
  }
  return 0;
}

}  // namespace

template <int D>
Vec<D> project_to_isosurface(const Field<D>& field, const Vec<D>& world, double isovalue) {
  const Vec<D> start = field.world_to_index.point(world);
  if (!holds_given(field, start)) return world;
  const CellPoint<D> point = locate(field, start);
  const CellCorners<D> corners = load_corners(field, point.cell);
  const double here = interpolate(corners, point.local) - isovalue;
  if (here == 0 || std::isnan(here)) return world;
  // At a crease between cells, the gradient of a cell may lead away from the isosurface.
  for (Vec<D> along : {geometric_gradient(corners, point.local), shading_gradient(field, point)}) {
    if (!(along.length() > 0)) continue;
    along *= (here < 0 ? 1 : -1) / along.length();
    const double t = first_crossing(field, start, along, isovalue, here < 0, 2, exact);
    if (t > 0) return field.index_to_world.point(locate(field, start + along * t).index_position());
  }
  return world;
}

Vec3 project_along(const Field<3>& field, const Vec3& world, const Vec3& outward, double isovalue,
                   double reach) {
  const Vec3 start = field.world_to_index.point(world);
  Vec3 along = field.world_to_index.vector(outward);
  if (!holds_given(field, start) || !(along.length() > 0)) return world;
  along /= along.length();
  const double after = first_crossing(field, start, along, isovalue, false, reach, quick);
  const double before =
      first_crossing(field, start, along * -1, isovalue, true, after > 0 ? after : reach, quick);
  const double t = before > 0 ? -before : after;
  if (t == 0) return world;
  return field.index_to_world.point(locate(field, start + along * t).index_position());
}

template Vec<2> project_to_isosurface<2>(const Field<2>&, const Vec<2>&, double);
template Vec<3> project_to_isosurface<3>(const Field<3>&, const Vec<3>&, double);

}  // namespace leaflight
