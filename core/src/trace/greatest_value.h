// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// Returns the greatest value of a field along position + t direction, 0 <= t <= t_max, in index
// coordinates. Returns `least` if no value is greater. Ignores cells next to a voxel without data.
// Skips bricks by their bounds, so it costs little more than a ray for one isovalue.
template <int D>
double greatest_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                      double t_max, double least);

// Returns the least value, or `most`.
template <int D>
double least_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                   double t_max, double most);

}  // namespace leaflight
