// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/kept_light.h"

#include <Imath/half.h>

#include <cmath>

namespace leaflight {

template <int D>
KeptLight<D>::KeptLight(const RadianceGrid<D>& grid, int rounds, int blocks)
    : resolution_(grid.lattice.resolution),
      active_(grid.lattice.active),
      light_(grid.unfiltered),
      rounds_(rounds),
      blocks_(blocks) {
  for (auto& side : light_.sides) {
    for (auto& light : side) {
      for (int i = 0; i < 3; ++i) light[i] = static_cast<float>(half(light[i]));
    }
  }
}

template <int D>
bool KeptLight<D>::fits(const TexelLattice<D>& shown, const TexelLattice<D>& soft,
                        bool back) const {
  return active_ == shown.active && light_.resolution == soft.resolution &&
         light_.texels == soft.active && light_.sides[1].empty() != back;
}

template <int D>
float KeptLight<D>::share(std::size_t slot, const Average& now, int blocks, bool inner) const {
  if (std::isnan(light_.sides[inner][slot].x)) return 0;
  if (!(now.samples > 0)) return 1;
  return static_cast<float>(blocks_) / static_cast<float>(blocks_ + blocks);
}

template <int D>
void KeptLight<D>::blend(NoisyLight& light, int blocks, bool inner) const {
  for (std::size_t s = 0; s < light.averages.size(); ++s) {
    Average& now = light.averages[s];
    const float w = share(s, now, blocks, inner);
    if (w == 0) continue;
    const Imath::V3f kept(light_.sides[inner][s]), apart = kept - Imath::V3f(now.mean);
    now.mean += Rgb(apart * w);
    if (w == 1) continue;
    now.variance *= 1 - w;
    now.samples /= 1 - w;
    if (light.halves.empty()) continue;
    HalfDifference& halves = light.halves[s];
    halves = {apart, w, halves.weight / (1 - w), true};
  }
}

template class KeptLight<2>;
template class KeptLight<3>;

}  // namespace leaflight
