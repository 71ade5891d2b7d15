// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace leaflight {

// Seconds that a first picture takes: for the points of its error, for its photons, for the rest.
struct PreviewSeconds {
  double points = 0, photons = 0, rest = 0;
  double all() const { return points + photons + rest; }
};

// Predicts those of a first pass without its walls. `texels`: how many times as many hold indirect
// light. Measured factors: docs/decisions/error-and-time.md.
inline double first_pass_seconds(const PreviewSeconds& preview, double texels) {
  constexpr double more_points = 3, more_photons = 5, power_of_texels = 0.55;
  return more_points * preview.points + more_photons * preview.photons +
         std::pow(texels, power_of_texels) * preview.rest;
}

}  // namespace leaflight
