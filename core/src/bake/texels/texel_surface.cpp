// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/texel_surface.h"

#include "base/parallel.h"

namespace leaflight {
namespace {

// Returns the mean shading gradient around a texel's center. A texel wider than a voxel contains
// isosurfaces away from its center.
template <int D>
Vec<D> mean_gradient(const Field<D>& field, const Vec<D>& width, const Vec<D>& center) {
  Vec<D> reach;
  for (int a = 0; a < D; ++a) reach[a] = 0.25 * std::max(0.0, width[a] - 1);
  if (!(reach.length() > 0)) return shading_gradient(field, locate(field, center));
  Vec<D> sum(0.0);
  for (int i = 0; i < 1 << D; ++i) {
    Vec<D> position = center;
    for (int a = 0; a < D; ++a) position[a] += i >> a & 1 ? reach[a] : -reach[a];
    sum += shading_gradient(field, locate(field, position));
  }
  return sum / (1 << D);
}

}  // namespace

template <int D>
std::vector<TexelSurface<D>> texel_surfaces(const LineVolume<D>& volume,
                                            const TexelLattice<D>& lattice, Progress& progress) {
  const Field<D>& field = volume.volume().field;
  const Affine<D> to_index = inverse(volume.tracer.index_to_frame(volume.number));
  std::vector<TexelSurface<D>> surfaces(lattice.active.size());
  parallel_range(surfaces.size(), 2048, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec<D> center = lattice.center(lattice.active[s]);
      const Vec<D> per_voxel = mean_gradient(field, lattice.voxels_per_texel, center);
      const CellPoint<D> at = locate(field, center);
      const Vec<D> gradient = to_index.pull_back_gradient(per_voxel);
      const double length = gradient.length();
      const double h = interpolate(load_corners(field, at.cell), at.local);
      if (!(length > 0) || std::isnan(h)) continue;
      surfaces[s] = {Vec<D, float>(gradient / -length), static_cast<float>(h),
                     static_cast<float>((per_voxel * lattice.voxels_per_texel).length())};
    }
  });
  return surfaces;
}

template std::vector<TexelSurface<2>> texel_surfaces<2>(const LineVolume<2>&,
                                                        const TexelLattice<2>&, Progress&);
template std::vector<TexelSurface<3>> texel_surfaces<3>(const LineVolume<3>&,
                                                        const TexelLattice<3>&, Progress&);

}  // namespace leaflight
