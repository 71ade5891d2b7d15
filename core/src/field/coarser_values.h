// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/field.h"

namespace leaflight {

// The field's values at the nodes of coarser_resolution(dims, 2) over its domain, axis 0 fastest.
// Between the borders each is a mean along each axis, with the weights 1, 6 and 1, of the values a
// voxel before it, at it and a voxel after it; so those of a linear function stay, and others are
// blurred as by the mean of two voxels. NaN where one of them is.
std::vector<float> coarser_values(const Field<3>& field);

}  // namespace leaflight
