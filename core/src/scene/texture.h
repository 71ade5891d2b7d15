// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/vector.h"

namespace leaflight {

// Linear colors over (u, v), bottom row first, interpolated between the centers of pixels.
struct Texture {
  int width = 0, height = 0;
  std::vector<Vec<3, float>> pixels;

  // Returns the color at (u, v). Repeats beyond 0..1, like Blender's image textures.
  Rgb at(double u, double v) const;
};

}  // namespace leaflight
