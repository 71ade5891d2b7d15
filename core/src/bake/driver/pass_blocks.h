// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace leaflight {

// True if no number of blocks reaches the target error. `bias`: the error in percent of any number.
bool is_out_of_reach(double error, double bias);

// Returns the noise, in percent, at which a bake ends: the part of the target error that the
// bias leaves, within bounds.
double noise_to_reach(double error, double bias);

// Returns the blocks of the first pass. At least two are needed to estimate the error.
int first_blocks(std::size_t texels);

// Returns the number of blocks after the next pass. It aims at the variance `target`, given the
// variance `noise` of `now` blocks. It is at most twice `now`, or eight.
int next_blocks(int now, double noise, double target);

}  // namespace leaflight
