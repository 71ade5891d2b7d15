// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/line_volume.h"

namespace leaflight {

// The isosurface through the center of a texel.
template <int D>
struct TexelSurface {
  Vec<D, float> normal{0.0f};      // unit length, towards lower values; zero if there is none
  float value = 0, steepness = 1;  // of the field; its gradient per texel width, positive
};

template <int D>
std::vector<TexelSurface<D>> texel_surfaces(const LineVolume<D>& volume,
                                            const TexelLattice<D>& lattice, Progress& progress);

// Returns the albedo of that isosurface.
template <int D>
Rgb texel_albedo(const Volume<D>& volume, const TexelLattice<D>& lattice, std::size_t slot);

}  // namespace leaflight
