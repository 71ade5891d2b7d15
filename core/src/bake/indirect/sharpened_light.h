// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/texels/line_volume.h"
#include "base/progress.h"
#include "base/vector.h"

namespace leaflight {

// Sharpens light that is read by linear interpolation. A texel holds the mean of its width, which
// changes the light by 1/24 of its second difference along each axis. Interpolation changes it by
// 1/12 on average. Half the difference between the texel and the binomial mean of its neighborhood
// undoes both. The result may be negative, because a limit would cut noise on one side and make
// the light too bright.
template <int D>
std::vector<Rgb> sharpened(const IndexedLattice<D>& texels, const std::vector<Rgb>& light,
                           Progress& progress);

}  // namespace leaflight
