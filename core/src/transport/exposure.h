// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// Whether a point of the isosurface can be seen from outside the domain: one of `directions` random
// rays from its front leaves the domain without hitting the isosurface again. Points are in the
// world; those outside the domain, in masked cells or without a gradient are not exposed.
template <int D>
std::vector<std::uint8_t> exposed(const Field<D>& field, const std::vector<Vec<D>>& points,
                                  double isovalue, int directions, std::uint64_t seed);

}  // namespace leaflight
