// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace leaflight {

// The time of a first picture in seconds: points of its error estimate, photons, and the rest.
struct PreviewSeconds {
  double points = 0, photons = 0, rest = 0;
  double all() const { return points + photons + rest; }
};

// Predicts the time of a first pass without walls. `texels`: ratio of its texels of indirect light
// to those of the first picture. Measured factors: docs/decisions/error-and-time.md.
inline double first_pass_seconds(const PreviewSeconds& preview, double texels) {
  constexpr double more_points = 3, more_photons = 5, power_of_texels = 0.55;
  return more_points * preview.points + more_photons * preview.photons +
         std::pow(texels, power_of_texels) * preview.rest;
}

}  // namespace leaflight
