// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/color_ramp.h"

#include <algorithm>

namespace leaflight {

Real ColorRamp::largest() const {
  Real most = 0;
  for (const Stop& stop : stops) most = std::max(most, leaflight::largest(stop.color));
  return most;
}

Rgb ColorRamp::between_stops(double position) const {
  const auto above = std::upper_bound(stops.begin(), stops.end(), position,
                                      [](double p, const Stop& stop) { return p < stop.position; });
  if (above == stops.begin()) return stops.front().color;
  if (above == stops.end()) return stops.back().color;
  const Stop& low = *(above - 1);
  const auto t = static_cast<Real>((position - low.position) / (above->position - low.position));
  return low.color * (1 - t) + above->color * t;
}

}  // namespace leaflight
