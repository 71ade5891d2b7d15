// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/radiance_grid.h"

namespace leaflight {

// Values at the active texels, such as a grid's radiance, as one image of RGBA pixels, bottom row
// first: slice k of the texture is the tile in column k % columns and row k / columns, without
// padding.
struct Atlas {
  int columns = 0, rows = 0;
  int width = 0, height = 0;
  std::vector<float> pixels;
};

// A shader blends eight texels whether or not they are active, so inactive texels next to active
// ones take the mean of their active neighbours.
Atlas make_atlas(const TexelLattice<3>& lattice, const std::vector<Vec<3, float>>& values);

}  // namespace leaflight
