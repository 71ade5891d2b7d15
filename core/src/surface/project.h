// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// The nearest point of the isosurface along its gradient, world to world, found by bracketed search
// within two voxels; the point itself where there is none.
template <int D>
Vec<D> project_to_isosurface(const Field<D>& field, const Vec<D>& point, double isovalue);

// The nearest point of the isosurface, along a direction or against it and world to world, where
// the field falls below the isovalue in that direction, within `reach` voxels; the point itself
// where there is none. So what is outside a thin shell does not come to its inner side.
Vec3 project_along(const Field<3>& field, const Vec3& point, const Vec3& outward, double isovalue,
                   double reach);

}  // namespace leaflight
