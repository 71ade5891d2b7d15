// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// Tests which points of an isosurface are visible from outside the domain. A point is visible if
// one of `directions` random rays from its front leaves the domain without another hit. Points are
// in world coordinates. Points outside the domain, in masked cells or without a gradient are not
// visible.
template <int D>
std::vector<std::uint8_t> seen_from_outside(const Field<D>& field,
                                            const std::vector<Vec<D>>& points, double isovalue,
                                            int directions, std::uint64_t seed);

}  // namespace leaflight
