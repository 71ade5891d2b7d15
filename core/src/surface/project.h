// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// The nearest point of the isosurface along its gradient, world to world, found by bracketed search
// within two voxels; the point itself where there is none.
template <int D>
Vec<D> project_to_isosurface(const Field<D>& field, const Vec<D>& point, double isovalue);

}  // namespace leaflight
