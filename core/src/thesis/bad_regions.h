// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/vector.h"

namespace leaflight {

// Bad examples of where to sample, of the thesis's Tables 3.1 and 4.2, as parts of a domain
// [0,1]^D.

// The letters B, A, D, the domain's bottom left out; extruded along z in space.
template <int D>
bool in_letters(const Vec<D>& unit);

// Five thin slabs, about the planes on which the mean of the coordinates is 0.1, 0.3, ... 0.9.
template <int D>
bool in_slabs(const Vec<D>& unit);

}  // namespace leaflight
