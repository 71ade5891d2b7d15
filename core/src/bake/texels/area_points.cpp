// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/area_points.h"

#include <cmath>

#include "base/random.h"
#include "field/shading_gradient.h"

namespace leaflight {

template <int D>
std::vector<AreaPoint<D>> area_points(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                                      std::uint64_t seed) {
  constexpr std::size_t most = 1 << 16;
  const Volume<D>& scene_volume = volume.volume();
  const Affine<D> to_index = inverse(volume.tracer.index_to_frame(volume.number));
  const std::size_t step = 1 + lattice.active_texels / most;
  std::vector<AreaPoint<D>> points;
  for (std::size_t s = 0; s < lattice.active_texels; s += step) {
    Random random = random_for(seed, Purpose::noise, s);
    Vec<D> position = lattice.center(lattice.active[s]);
    for (int a = 0; a < D; ++a) {
      position[a] += (random.uniform() - 0.5) * lattice.voxels_per_texel[a];
    }
    const CellPoint<D> at = locate(scene_volume.field, position);
    const double h = interpolate(load_corners(scene_volume.field, at.cell), at.local);
    if (!volume.isovalue_range().contains(h)) continue;
    // By the coarea formula, the density of isosurfaces is the length of the gradient of h.
    const double area =
        to_index.pull_back_gradient(shading_gradient(scene_volume.field, at)).length();
    if (area > 0) points.push_back({position, at, scene_volume.common_isovalue(h), area});
  }
  return points;
}

template std::vector<AreaPoint<2>> area_points(const LineVolume<2>&, const TexelLattice<2>&,
                                               std::uint64_t);
template std::vector<AreaPoint<3>> area_points(const LineVolume<3>&, const TexelLattice<3>&,
                                               std::uint64_t);

}  // namespace leaflight
