// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/leaf_light.h"
#include "leaflight/bake/swept_volume.h"

namespace leaflight {

// Adds one sample of direct light, of the source, to each texel. A line from the source lights
// points of all leaves at once: on its way a point of the outer side is lit if the field's value
// there is larger than any before, since a leaf blocks the way where its value is taken; of the
// inner side, if it is smaller. A line so costs as much as one shadow ray and serves every texel
// that it crosses. `leaf_light`, if given, takes the source.
template <int D>
void sweep_direct(const SweptVolume<D>& volume, const SweptLattice<D>& texels,
                  const LightSource<D>& source, const std::array<double, 2>& offset,
                  Progress& progress, std::atomic<std::uint64_t>& lines, SideMoments& moments,
                  LeafLight<D>* leaf_light);

}  // namespace leaflight
