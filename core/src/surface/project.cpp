// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/project.h"

#include <cmath>

#include "leaflight/field/given_point.h"

namespace leaflight {

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
  double low = 0;
  for (double high = step; high <= reach; low = high, high += step) {
    const double there = value(start + along * high);
    if (std::isnan(there)) break;
    if ((there < 0) == (here < 0)) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((value(start + along * middle) < 0) == (here < 0) ? low : high) = middle;
    }
    return field.index_to_world.point(locate(field, start + along * high).index_position());
  }
  return world;
}

template Vec<2> project_to_leaf<2>(const Field<2>&, const Vec<2>&, double);
template Vec<3> project_to_leaf<3>(const Field<3>&, const Vec<3>&, double);

}  // namespace leaflight
