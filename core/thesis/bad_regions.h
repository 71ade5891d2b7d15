// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/vector.h"

namespace leaflight {

// Regions of a domain [0,1]^D that the thesis's Tables 3.1 and 4.2 use as bad examples for samples.

// True inside the letters B, A, D, which leave the domain's bottom empty; extruded along z in 3D.
template <int D>
bool in_letters(const Vec<D>& unit);

// True inside five thin slabs, around the planes where the mean of the coordinates is 0.1, 0.3, ...
// 0.9.
template <int D>
bool in_slabs(const Vec<D>& unit);

}  // namespace leaflight
