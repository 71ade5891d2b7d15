// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/field.h"

namespace leaflight {

// Of a grid with half as many voxels along each axis, rounded up.
Index<3> coarser_dims(const Index<3>& dims);

// The field's values at the voxels of such a grid over the same domain, axis 0 fastest. Between
// its borders each is a mean along each axis, with the weights 1, 2 and 1, of the values a voxel
// before it, at it and a voxel after it; so those of a linear function stay. NaN where one of them
// is.
std::vector<float> coarser_values(const Field<3>& field);

}  // namespace leaflight
