// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/vector.h"

namespace leaflight {

// The mean of samples, and the variance of this mean, averaged over the channels.
struct Average {
  Rgb mean{0};
  float variance = 0;
  float samples = 0;  // effective number of samples of equal weight (Kish 1965)
};

}  // namespace leaflight
