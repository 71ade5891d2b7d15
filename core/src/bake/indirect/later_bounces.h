// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/vector.h"

namespace leaflight {

// Returns the sum of all bounces after `last`, as a multiple of `last`. Extrapolates a geometric
// series from `before` and `last`, which have one value per texel.
Rgb later_bounces(const std::vector<Rgb>& before, const std::vector<Rgb>& last);

}  // namespace leaflight
