// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/sharpened_light.h"

#include "bake/texels/texel_neighbors.h"
#include "base/parallel.h"

namespace leaflight {

template <int D>
std::vector<Rgb> sharpened(const IndexedLattice<D>& texels, const std::vector<Rgb>& light,
                           Progress& progress) {
  constexpr float half = 0.5f;
  std::vector<Rgb> result(light.size());
  const TexelNeighbors<D> neighbors(texels, 1);
  parallel_each(light.size(), 2048, progress, [&](std::size_t s) {
    Rgb difference(0);
    neighbors.for_each_pair(s, [&](std::size_t a, std::size_t b, float weight) {
      difference += (light[s] * 2 - light[a] - light[b]) * weight;
    });
    result[s] = light[s] + difference * half;
  });
  return result;
}

template std::vector<Rgb> sharpened<2>(const IndexedLattice<2>&, const std::vector<Rgb>&,
                                       Progress&);
template std::vector<Rgb> sharpened<3>(const IndexedLattice<3>&, const std::vector<Rgb>&,
                                       Progress&);

}  // namespace leaflight
