// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// The greatest value of a field along position + t direction, 0 <= t <= t_max, in index
// coordinates, or `least` where no value is greater. Cells next to a voxel without data do not
// count. Bricks whose bounds show no greater value are skipped, so that a way costs little more
// than the ray of one isovalue.
template <int D>
double greatest_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                      double t_max, double least);

// The same of the least one, or `most`.
template <int D>
double least_value(const Field<D>& field, const Vec<D>& position, const Vec<D>& direction,
                   double t_max, double most);

}  // namespace leaflight
