// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "base/vector.h"

namespace leaflight {

// A color over the common isovalue. It is linear between stops in ascending order, and constant
// beyond the first and the last.
struct ColorRamp {
  struct Stop {
    double position;
    Rgb color;
  };
  std::vector<Stop> stops;

  ColorRamp(const Rgb& color = Rgb(0)) : stops{{0, color}} {}  // NOLINT: a color is a ramp
  explicit ColorRamp(std::vector<Stop> all) : stops(std::move(all)) {}

  Rgb at(double position) const {
    if (stops.size() == 1) return stops.front().color;
    return between_stops(position);
  }
  // Returns the largest channel of any color.
  Real largest() const;

 private:
  Rgb between_stops(double position) const;
};

}  // namespace leaflight
