// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/radiance_grid.h"

namespace leaflight {

// Values at the active texels, such as a grid's radiance, as one RGBA image, bottom row first.
// Slice k of the texture is the tile in column k % columns and row k / columns, without padding.
struct Atlas {
  int columns = 0, rows = 0;
  int width = 0, height = 0;
  std::vector<float> pixels;
};

// Makes the image. A shader interpolates eight texels, active or not. So inactive texels next to
// active ones get the mean of their active neighbors.
Atlas make_atlas(const TexelLattice<3>& lattice, const std::vector<Vec<3, float>>& values);

}  // namespace leaflight
