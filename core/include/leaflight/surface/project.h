// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/field/field.h"

namespace leaflight {

// The nearest point of the leaf along its gradient, world to world, found by bracketed search
// within two voxels; the point itself where there is none.
Vec3 project_to_leaf(const Field<3>& field, const Vec3& point, double isovalue);

}  // namespace leaflight
