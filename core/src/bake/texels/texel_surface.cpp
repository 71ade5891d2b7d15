// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/texel_surface.h"

#include "base/parallel.h"
#include "field/cap_layers.h"

namespace leaflight {
namespace {

// Returns the mean shading gradient around the place of a slot. A texel wider than a voxel contains
// isosurfaces away from its center.
template <int D>
Vec<D> mean_gradient(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot,
                     const Vec<D>& center) {
  Vec<D> reach;
  for (int a = 0; a < D; ++a) reach[a] = 0.25 * std::max(0.0, lattice.voxels_per_texel[a] - 1);
  if (!(reach.length() > 0)) return slot_gradient(field, lattice, slot, center);
  Vec<D> sum(0.0);
  for (int i = 0; i < 1 << D; ++i) {
    Vec<D> position = center;
    for (int a = 0; a < D; ++a) position[a] += i >> a & 1 ? reach[a] : -reach[a];
    sum += slot_gradient(field, lattice, slot, position);
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
  parallel_each(surfaces.size(), 2048, progress, [&](std::size_t s) {
    const Vec<D> center = slot_position(field, lattice, s);
    const Vec<D> per_voxel = mean_gradient(field, lattice, s, center);
    const Vec<D> gradient = to_index.pull_back_gradient(per_voxel);
    const double length = gradient.length();
    const double h = slot_value(field, lattice, s);
    if (!(length > 0) || std::isnan(h)) return;
    surfaces[s] = {Vec<D, float>(gradient / -length), static_cast<float>(h),
                   static_cast<float>((per_voxel * lattice.voxels_per_texel).length())};
  });
  return surfaces;
}

template <int D>
Rgb texel_albedo(const Volume<D>& volume, const TexelLattice<D>& lattice, std::size_t slot) {
  if (volume.albedo.stops.size() == 1) return volume.albedo.at(0);
  const double h = slot_value(volume.field, lattice, slot);
  return volume.albedo.at(std::isnan(h) ? 0 : volume.common_isovalue(h));
}

template Rgb texel_albedo<2>(const Volume<2>&, const TexelLattice<2>&, std::size_t);
template Rgb texel_albedo<3>(const Volume<3>&, const TexelLattice<3>&, std::size_t);
template std::vector<TexelSurface<2>> texel_surfaces<2>(const LineVolume<2>&,
                                                        const TexelLattice<2>&, Progress&);
template std::vector<TexelSurface<3>> texel_surfaces<3>(const LineVolume<3>&,
                                                        const TexelLattice<3>&, Progress&);

}  // namespace leaflight
