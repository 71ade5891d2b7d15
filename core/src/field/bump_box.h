// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/vector.h"

namespace leaflight {

// Returns the thesis's reference data set (Eq. 2.1, Table 2.1) on n^D voxels of the unit square or
// cube, mapped linearly to 0..255. The exponent is as printed, -|x-p|^2 / (2 sigma)^2. In 2D the z
// term is dropped (with z = 0 the three narrow bumps would vanish).
template <int D>
std::vector<float> bump_box(int n);

}  // namespace leaflight
