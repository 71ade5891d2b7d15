// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "bake/direct/direct_light.h"
#include "base/packed_numbers.h"
#include "field/texel_lattice.h"

namespace leaflight {

// The precision of a bake's numbers, in memory and in its file. Rounding errs by at most 0.05 % in
// light and errors, and 0.8 % in light before the filter, which is mostly noise.
constexpr ShortFloat light_precision{0}, error_precision{0}, unfiltered_precision{4};

// Indirect light of white isosurfaces before the filter, at its own texels, by side. A bake can
// continue from it. NaN where no line has passed.
template <int D>
struct UnfilteredLight {
  TexelLattice<D> lattice;
  std::array<PackedNumbers, 2> sides;
};

// Light of the isosurfaces of one volume. It is the radiance [W/(m^2 sr)] at the active texels of a
// lattice, in the order of `lattice.active`.
template <int D>
struct RadianceGrid {
  TexelLattice<D> lattice;
  // Light of the front. Empty if derives_radiance(), unless it was needed.
  std::vector<Vec<3, float>> radiance;
  std::vector<Vec<3, float>> radiance_indirect;  // without direct light
  std::vector<float> radiance_error;             // standard error of the mean over the channels
  // Light of the back; empty if it was not baked.
  std::vector<Vec<3, float>> radiance_back, radiance_back_indirect;
  // Exact direct light; null: texels contain it. The sum with radiance_indirect is all light.
  std::shared_ptr<const DirectLight<D>> direct;
  // Maps of a grid from a file, until they become direct light.
  std::shared_ptr<const StoredMaps<D>> maps;
  UnfilteredLight<D> unfiltered;  // of bakes in passes
  // Texture of the volume, by which lookups multiply the light; null: none, or in the texels.
  std::shared_ptr<const VolumeTexture<D>> texture;

  bool has_back() const { return !radiance_back_indirect.empty(); }
  // True if the light of a side's texels is the sum of radiance_indirect and exact direct light.
  bool derives_radiance(bool back) const { return direct && (!back || direct->has_back()); }
  // True if the light of a side is known.
  bool has_light(bool back) const {
    return derives_radiance(back) || (back ? radiance_back : radiance).size() == texels();
  }
  std::size_t texels() const { return lattice.active.size(); }
};

// Returns all light of a texel, on one side, as the sum of direct and indirect light. The field
// must be the one that was lit.
template <int D>
Vec<3, float> derived_radiance(const RadianceGrid<D>& grid, const Field<D>& field, std::size_t slot,
                               bool back);

// Returns the same from `radiance`, if that is known.
template <int D>
Vec<3, float> radiance_of_texel(const RadianceGrid<D>& grid, const Field<D>& field,
                                std::size_t slot, bool back);

// Returns all light of the texels of one side.
template <int D>
std::vector<Vec<3, float>> all_light(const RadianceGrid<D>& grid, const Field<D>& field, bool back);

// A grid for display, with its lights and texture as baked or changed.
template <int D>
struct ShownGrid {
  const RadianceGrid<D>& grid;
  const DirectLight<D>* direct;  // direct light at these strengths; null: texels contain it
  Vec<3, float> indirect{1, 1,
                         1};  // factor on all other light, except the emission of the isosurface

  const VolumeTexture<D>* texture;  // factor on all light; null: none

  ShownGrid(const RadianceGrid<D>& baked)  // NOLINT: implicit, for display as baked
      : grid(baked), direct(baked.direct.get()), texture(baked.texture.get()) {}
  ShownGrid(const RadianceGrid<D>& baked, const DirectLight<D>* scaled, const Vec<3, float>& factor)
      : grid(baked), direct(scaled), indirect(factor), texture(baked.texture.get()) {}

  // Returns the direct light of one side, or null if its texels contain it.
  const DirectLight<D>* direct_of(bool back) const {
    return direct && (!back || direct->has_back()) ? direct : nullptr;
  }
  // True if the light of a side is known.
  bool has_light(bool back) const { return direct_of(back) || grid.has_light(back); }
  // Multiplies light by the texture at an index position.
  Vec<3, float> textured(const Vec<3, float>& light, const Vec<D>& index_position) const {
    if (!texture) return light;
    return light * Vec<3, float>(texture->at(index_position));
  }
  // Scales a value of radiance_indirect to these strengths.
  Vec<3, float> scaled(const Vec<3, float>& light, const Field<D>& field,
                       const Vec<D>& index_position) const;
};

// Throws Error if the light of a side is not known.
template <int D>
void check_light(const ShownGrid<D>& shown, bool back);

// Returns the radiance of the isosurface through an index position, on one of its sides. The field
// must be the one that was lit, and the grid must contain that side.
template <int D>
Vec<3, float> radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                          const Vec<D>& index_position, bool back);
template <int D>
Vec<3, float> radiance_at(const RadianceGrid<D>& grid, const Field<D>& field,
                          const Vec<D>& index_position, bool back) {
  return radiance_at(ShownGrid<D>(grid), field, index_position, back);
}

// Interpolates an array of texels linearly along each axis, over the active texels only; on a cap,
// over its layers. Returns zero if there are none.
template <int D>
Vec<3, float> lookup(const Field<D>& field, const TexelLattice<D>& lattice,
                     const std::vector<Vec<3, float>>& values, const Vec<D>& index_position);

// Looks up many positions, into an array of the same size at `found`. Prefetches, because the
// texels are far apart in memory.
template <int D>
void radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                 const std::vector<Vec<D>>& index_positions, bool back, Vec<3, float>* found);

// Returns the standard error of such a radiance, for independent errors of the texels.
template <int D>
float lookup_error(const Field<D>& field, const TexelLattice<D>& lattice,
                   const std::vector<float>& errors, const Vec<D>& index_position);

}  // namespace leaflight
