// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/rounds_texels.h"

namespace leaflight {
namespace {

// Texels that a bake has by default, at most, where they are finer than voxels.
constexpr std::size_t most_finer_texels = 2'500'000, most_finer_soft_texels = 500'000;
constexpr int most_halvings = 2;
// Where leaves pass more voxels than these, soft light's lines are two texels apart, its texels are
// coarser than voxels, those that photons fall into are.
constexpr std::size_t most_dense_voxels = 200'000, most_soft_voxels = 20'000'000,
                      most_photon_voxels = 300'000;
constexpr int widest_texel = 8;
// Those of a first picture are so many voxels wide.
constexpr int preview_width = 4;
// Photons tell of the light that has bounced more than once before sweeps know it, and of the soft
// light of the surroundings.
constexpr std::uint64_t photons = 400'000, preview_photons = 20'000;

template <int D>
TexelLattice<D> lattice_of(const SweptVolume<D>& volume, const Index<D>& resolution) {
  const IsovalueWindow window = volume.window();
  return make_lattice(volume.volume().field, resolution, window.min, window.max);
}

// A lattice with texels of so many voxels.
template <int D>
TexelLattice<D> lattice_of(const SweptVolume<D>& volume, int voxels_per_texel) {
  return lattice_of(volume, coarser_resolution<D>(volume.volume().field.dims, voxels_per_texel));
}

// Voxels, or texels finer than these where they are few.
template <int D>
TexelLattice<D> finest_lattice(const SweptVolume<D>& volume, TexelLattice<D> voxels,
                               std::size_t most) {
  for (int i = 0; i < most_halvings && voxels.active.size() << D <= most; ++i) {
    voxels = lattice_of(volume, finer_resolution<D>(voxels.resolution));
  }
  return voxels;
}

// How wide texels are for leaves to pass at most so many, given the voxels that they pass.
int width_for(std::size_t voxels, std::size_t most, int dimension) {
  int width = 1;
  while (width < widest_texel && voxels > most) {
    width *= 2;
    voxels >>= dimension;
  }
  return width;
}

}  // namespace

template <int D>
SweptTexels<D> rounds_texels(const SweptVolume<D>& volume, const BakeSettings<D>& settings) {
  const bool given = settings.resolution != Index<D>{};
  const IsovalueWindow window = volume.window();
  const Field<D>& field = volume.volume().field;
  const TexelLattice<D> voxels = given ? TexelLattice<D>{} : lattice_of(volume, 1);
  const std::size_t count =
      given ? active_texels(field, field.dims, window.min, window.max) : voxels.active.size();
  const int width = width_for(count, most_soft_voxels, D);
  SweptTexels<D> texels;
  texels.direct = SweptLattice<D>(given ? lattice_of(volume, settings.resolution)
                                        : finest_lattice(volume, voxels, most_finer_texels));
  texels.soft =
      SweptLattice<D>(given || width > 1 ? lattice_of(volume, width)
                                         : finest_lattice(volume, voxels, most_finer_soft_texels));
  texels.spacing = count > most_dense_voxels ? 2 : 1;
  texels.photons = lattice_of(volume, width_for(count, most_photon_voxels, D));
  texels.photon_count = photons;
  return texels;
}

template <int D>
SweptTexels<D> preview_texels(const SweptVolume<D>& volume) {
  SweptTexels<D> texels;
  texels.photons = lattice_of(volume, preview_width);
  texels.direct = texels.soft = SweptLattice<D>(texels.photons);
  texels.photon_count = preview_photons;
  return texels;
}

template SweptTexels<2> rounds_texels(const SweptVolume<2>&, const BakeSettings<2>&);
template SweptTexels<3> rounds_texels(const SweptVolume<3>&, const BakeSettings<3>&);
template SweptTexels<2> preview_texels(const SweptVolume<2>&);
template SweptTexels<3> preview_texels(const SweptVolume<3>&);

}  // namespace leaflight
