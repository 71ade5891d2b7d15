// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/vector.h"

namespace leaflight {

// Throws Error unless all channels of an emission are finite and 0 or more. `what`: its quantity.
inline void check_light_amount(const Rgb& amount, const std::string& name,
                               const std::string& what) {
  for (int i = 0; i < 3; ++i) {
    if (!(amount[i] >= 0) || !std::isfinite(amount[i])) {
      throw Error(name + " has a negative or non-finite " + what +
                  "; choose one that is 0 or more.");
    }
  }
}

// Throws Error if a light is not within the bounds of the world.
inline void check_is_bounded(bool bounded, const std::string& name) {
  if (bounded) return;
  throw Error(name + " has a position or size that is not a number or above 1e18; correct it.");
}

}  // namespace leaflight
