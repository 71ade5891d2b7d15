// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/field.h"

namespace leaflight {

// Returns the field's values at the nodes of coarser_resolution(dims, 2) over its domain, axis 0
// fastest. Inside the border, each is a mean along each axis. The weights are 1, 6 and 1, for the
// values one voxel before it, at it and one voxel after it. Linear functions are preserved; others
// are blurred like a mean of two voxels. NaN if one of the values is NaN.
std::vector<float> coarser_values(const Field<3>& field);

}  // namespace leaflight
