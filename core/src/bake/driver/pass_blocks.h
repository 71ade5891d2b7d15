// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace leaflight {

// The noise, in percent, at which a bake of this target error and this texture error ends: what the
// texture error leaves of the target, within bounds.
double noise_to_reach(double error, double texture);

// Blocks of the first pass of a bake of so many texels. The difference of two shows the error.
int first_blocks(std::size_t texels);

// The blocks after the next pass: as many as leave the noise `target`, a variance, by what was
// found so far; at most twice as many as now, or eight.
int next_blocks(int now, double noise, double target);

}  // namespace leaflight
