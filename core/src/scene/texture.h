// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vector.h"

namespace leaflight {

// Linear colours over (u, v), bottom row first, interpolated between the centres of pixels.
struct Texture {
  int width = 0, height = 0;
  std::vector<Vec<3, float>> pixels;

  // Repeats beyond 0..1, as Blender's image textures do.
  Rgb at(double u, double v) const;
};

}  // namespace leaflight
