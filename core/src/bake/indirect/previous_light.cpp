// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/previous_light.h"

#include <cmath>
#include <stdexcept>

#include "base/error.h"

namespace leaflight {

template <int D>
PreviousLight<D>::PreviousLight(const RadianceGrid<D>& grid, int passes, int blocks)
    : resolution_(grid.lattice.resolution),
      active_(grid.lattice.active),
      indirect_resolution_(grid.unfiltered.lattice.resolution),
      indirect_texels_(grid.unfiltered.lattice.active),
      passes_(passes),
      blocks_(blocks) {
  try {
    for (int side = 0; side < 2; ++side) {
      sides_[side] = unpacked_colors(grid.unfiltered.sides[side]);
    }
  } catch (const std::runtime_error&) {
    throw Error("The bake to continue is damaged; bake the volume again.");
  }
}

template <int D>
bool PreviousLight<D>::fits(const TexelLattice<D>& shown, const TexelLattice<D>& indirect,
                            bool back) const {
  return active_ == shown.active && indirect_resolution_ == indirect.resolution &&
         indirect_texels_ == indirect.active && sides_[1].empty() != back;
}

template <int D>
float PreviousLight<D>::share(std::size_t slot, const Average& now, int blocks, bool back) const {
  if (std::isnan(sides_[back][slot].x)) return 0;
  if (!(now.samples > 0)) return 1;
  return static_cast<float>(blocks_) / static_cast<float>(blocks_ + blocks);
}

template <int D>
void PreviousLight<D>::blend(NoisyLight& light, int blocks, bool back) const {
  for (std::size_t s = 0; s < light.averages.size(); ++s) {
    Average& now = light.averages[s];
    const float w = share(s, now, blocks, back);
    if (w == 0) continue;
    const Imath::V3f previous(sides_[back][s]), difference = previous - Imath::V3f(now.mean);
    now.mean += Rgb(difference * w);
    if (w == 1) {
      // The number of samples is unknown and at least one.
      now.samples = 1;
      continue;
    }
    now.variance *= 1 - w;
    now.samples /= 1 - w;
    if (light.halves.empty()) continue;
    HalfDifference& halves = light.halves[s];
    halves = {difference, w, halves.weight / (1 - w)};
  }
}

template class PreviousLight<2>;
template class PreviousLight<3>;

}  // namespace leaflight
