// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/pass_texels.h"

#include <algorithm>
#include <functional>

#include "field/cap_layers.h"

namespace leaflight {
namespace {

// Upper bounds on the default texels if they are finer than voxels.
constexpr std::size_t most_finer_texels = 2'500'000, most_finer_indirect_texels = 500'000;
constexpr int most_halvings = 2;
// Upper bounds on the fine texels, and on the texels of their lattice, which lines pass.
constexpr std::size_t most_refined_texels = 5'000'000, most_refined_lattice = 32'000'000;
// Limits on the number of voxels that isosurfaces cross. Above the first, lines of indirect light
// are two texels apart. Above the second, texels of indirect light are wider than voxels. Above the
// third, so are those of photons.
constexpr std::size_t most_dense_voxels = 200'000, most_indirect_voxels = 20'000'000,
                      most_photon_voxels = 300'000;
constexpr int widest_texel = 8, wide_by = 2;
// Photons of a block of rays; each block traces its own.
constexpr std::uint64_t ray_photons = 100'000;
// Upper bound on the texels of indirect light if rays are traced from each.
constexpr std::size_t most_ray_texels = 500'000;
// Upper bound on the texels of indirect light if the caller gives a resolution with fewer texels.
constexpr std::size_t most_given_indirect_texels = 500'000;
// Width of a texel of a first picture, in voxels.
constexpr int preview_width = 4;
// Number of photons. They carry the indirect light of the walls, and light of several bounces until
// line passes have sampled it.
constexpr std::uint64_t photons = 400'000, preview_photons = 20'000;
// Shadow rays per patch of the walls.
constexpr int wall_samples = 8, preview_wall_samples = 2;

// A function that counts the texels that isosurfaces cross.
template <int D>
using Counted = std::function<std::size_t(const Index<D>& resolution)>;

// Halves the width of texels while their number stays small. `count`: their number at `resolution`.
template <int D>
Index<D> finest(Index<D> resolution, std::size_t count, std::size_t most,
                const Counted<D>& counted) {
  for (int i = 0; i < most_halvings && count << D <= most; ++i) {
    resolution = finer_resolution<D>(resolution);
    count = counted(resolution);
  }
  return resolution;
}

// Returns the texel width at which isosurfaces cross at most `most` texels. `voxels`: number of
// voxels that they cross.
int width_for(std::size_t voxels, std::size_t most, int dimension) {
  int width = 1;
  while (width < widest_texel && voxels > most) {
    width *= 2;
    voxels >>= dimension;
  }
  return width;
}

// Returns a lattice; it has no active texels for mirrors and glass, whose light depends on the
// view.
template <int D>
TexelLattice<D> lattice_of(const LineVolume<D>& volume, const Index<D>& resolution) {
  const Field<D>& field = volume.volume().field;
  if (volume.volume().scattering != Scattering::diffuse) {
    return inactive_lattice<D>(field.dims, resolution);
  }
  const IsovalueRange isovalue_range = volume.isovalue_range();
  return make_lattice(field, resolution, isovalue_range.min, isovalue_range.max);
}

}  // namespace

template <int D>
PassResolutions<D> pass_resolutions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                    const BakeSettings<D>& settings, Texels kind) {
  std::vector<std::pair<Index<D>, std::size_t>> known;
  const Counted<D> counted = [&](const Index<D>& resolution) {
    for (const auto& [other, count] : known) {
      if (other == resolution) return count;
    }
    const std::size_t count =
        active_texels(field, resolution, isovalue_range.min, isovalue_range.max);
    known.emplace_back(resolution, count);
    return count;
  };
  // Start with texels of indirect light that are as wide as voxels, or wider for large volumes.
  const bool given = settings.resolution != Index<D>{};
  const std::size_t voxels = counted(field.dims);
  PassResolutions<D> found;
  int width = width_for(voxels, most_indirect_voxels, D);
  found.indirect = coarser_resolution<D>(field.dims, width);
  if (given) {
    check_resolution<D>(settings.resolution);
    found.shown = settings.resolution;
    // Indirect light needs no finer texels than the result, unless they are cheap.
    const std::size_t asked = counted(found.shown);
    if (asked >= most_given_indirect_texels && counted(found.indirect) > asked)
      found.indirect = found.shown;
    while (counted(found.indirect) > std::max(most_given_indirect_texels, asked)) {
      width *= 2;
      found.indirect = coarser_resolution<D>(field.dims, width);
    }
  } else {
    found.shown = finest<D>(field.dims, voxels, most_finer_texels, counted);
    if (width == 1)
      found.indirect = finest<D>(field.dims, voxels, most_finer_indirect_texels, counted);
    const Index<D> fine = finer_resolution<D>(field.dims);
    if (kind == Texels::fine && field.voxels() << D <= most_refined_lattice &&
        voxels << D <= most_refined_texels && counted(fine) <= most_refined_texels) {
      if (found.shown == field.dims) found.shown = fine;
      if (found.indirect == field.dims) found.indirect = fine;
    }
  }
  // Choose the lines and the texels of photons by the number of crossed voxels.
  found.spacing = voxels > most_dense_voxels ? 2 : 1;
  found.photons = coarser_resolution<D>(field.dims, width_for(voxels, most_photon_voxels, D));
  if (kind == Texels::wide) {
    found.shown = coarser_resolution<D>(found.shown, wide_by);
    found.indirect = coarser_resolution<D>(found.indirect, wide_by);
  }
  return found;
}

template <int D>
BakeTexels<D> pass_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                          Texels kind) {
  const PassResolutions<D> chosen =
      pass_resolutions(volume.volume().field, volume.isovalue_range(), settings, kind);
  BakeTexels<D> texels;
  const auto layered = [&](const Index<D>& resolution) {
    TexelLattice<D> lattice = lattice_of(volume, resolution);
    const IsovalueRange isovalue_range = volume.isovalue_range();
    add_cap_layers(volume.volume().field, isovalue_range.min, isovalue_range.max, lattice);
    return IndexedLattice<D>(std::move(lattice));
  };
  texels.shown = layered(chosen.shown);
  texels.indirect = chosen.indirect == chosen.shown ? texels.shown : layered(chosen.indirect);
  texels.spacing = chosen.spacing;
  texels.photons = lattice_of(volume, chosen.photons);
  texels.photon_count = photons;
  texels.wall_samples = wall_samples;
  return texels;
}

template <int D>
BakeTexels<D> ray_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                         Texels kind) {
  BakeTexels<D> texels = pass_texels(volume, settings, kind);
  const Field<D>& field = volume.volume().field;
  const IsovalueRange isovalue_range = volume.isovalue_range();
  Index<D> indirect = field.dims;
  for (int a = 0; a < D; ++a)
    indirect[a] = std::min(indirect[a], texels.shown.lattice.resolution[a]);
  while (active_texels(field, indirect, isovalue_range.min, isovalue_range.max) > most_ray_texels &&
         *std::min_element(indirect.begin(), indirect.end()) > 2 * widest_texel) {
    indirect = coarser_resolution<D>(indirect, 2);
  }
  texels.indirect = IndexedLattice<D>(lattice_of(volume, indirect));
  texels.photon_count = ray_photons;
  return texels;
}

template <int D>
BakeTexels<D> preview_texels(const LineVolume<D>& volume, const Index<D>& resolution) {
  const Index<D> by_voxels = coarser_resolution<D>(volume.volume().field.dims, preview_width);
  const Index<D> by_texels = coarser_resolution<D>(resolution, preview_width);
  Index<D> coarser;
  for (int a = 0; a < D; ++a) coarser[a] = std::min(by_voxels[a], by_texels[a]);
  BakeTexels<D> texels;
  texels.photons = lattice_of(volume, coarser);
  texels.shown = texels.indirect = IndexedLattice<D>(texels.photons);
  texels.photon_count = preview_photons;
  texels.wall_samples = preview_wall_samples;
  return texels;
}

template PassResolutions<2> pass_resolutions(const Field<2>&, const IsovalueRange&,
                                             const BakeSettings<2>&, Texels);
template PassResolutions<3> pass_resolutions(const Field<3>&, const IsovalueRange&,
                                             const BakeSettings<3>&, Texels);
template BakeTexels<2> pass_texels(const LineVolume<2>&, const BakeSettings<2>&, Texels);
template BakeTexels<3> pass_texels(const LineVolume<3>&, const BakeSettings<3>&, Texels);
template BakeTexels<2> ray_texels(const LineVolume<2>&, const BakeSettings<2>&, Texels);
template BakeTexels<3> ray_texels(const LineVolume<3>&, const BakeSettings<3>&, Texels);
template BakeTexels<2> preview_texels(const LineVolume<2>&, const Index<2>&);
template BakeTexels<3> preview_texels(const LineVolume<3>&, const Index<3>&);

}  // namespace leaflight
