// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vector.h"

namespace leaflight {

// The light of all bounces after `last`, as a multiple of it, by the geometric series that it and
// the bounce `before` begin. Both have a value for each texel.
Rgb later_bounces(const std::vector<Rgb>& before, const std::vector<Rgb>& last);

}  // namespace leaflight
