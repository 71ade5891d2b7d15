// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "field/field.h"

namespace leaflight {

// The means over blocks of 2^3 voxels, dims / 2 of them, axis 0 fastest; NaN where one of them is.
// A block of index i lies at index 2 i + 1/2 of the field.
std::vector<float> coarser_values(const Field<3>& field);

}  // namespace leaflight
