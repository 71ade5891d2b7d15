// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "bake/direct/direct_light.h"
#include "field/texel_lattice.h"
#include "math/sample_average.h"

namespace leaflight {

// Indirect light of white isosurfaces before the filter, at its own texels, by side: what a bake
// goes on with. Not a number where no line has passed.
template <int D>
struct UnfilteredLight {
  Index<D> resolution{};
  std::vector<std::uint32_t> texels;  // the active ones, ascending
  std::array<std::vector<Vec<3, float>>, 2> sides;
};

// Light of the isosurfaces of one volume: radiance [W/(m^2 sr)] at the active texels of a lattice,
// in the order of `lattice.active`.
template <int D>
struct RadianceGrid {
  TexelLattice<D> lattice;
  // The front.
  std::vector<Vec<3, float>> radiance;
  std::vector<Vec<3, float>> radiance_indirect;  // all of it but direct light
  std::vector<float> radiance_error;             // standard error of the mean over the channels
  // The back; empty where it was not baked.
  std::vector<Vec<3, float>> radiance_back, radiance_back_indirect;
  // Exact direct light, which with radiance_indirect is all light; null: texels hold all that is
  // known. What it does not hold is in radiance_indirect.
  std::shared_ptr<const DirectLight<D>> direct;
  UnfilteredLight<D> unfiltered;  // of bakes in passes

  bool has_back() const { return !radiance_back.empty(); }
  std::size_t texels() const { return lattice.active.size(); }
};

// Averages of the front and the back; the latter's are empty where it is not baked.
using SideAverages = std::array<std::vector<Average>, 2>;

// A grid without its lattice, from averages of the active texels.
template <int D>
RadianceGrid<D> make_grid(SideAverages direct, SideAverages indirect);

// A grid as it is shown: with its lights as they were baked, or at other strengths.
template <int D>
struct ShownGrid {
  const RadianceGrid<D>& grid;
  const DirectLight<D>* direct;  // of the strengths; null: texels hold all that is known
  Vec<3, float> indirect{1, 1,
                         1};  // a factor of all other light but what the isosurface itself emits

  ShownGrid(const RadianceGrid<D>& baked)  // NOLINT: a grid is shown as it was baked
      : grid(baked), direct(baked.direct.get()) {}
  ShownGrid(const RadianceGrid<D>& baked, const DirectLight<D>* scaled, const Vec<3, float>& factor)
      : grid(baked), direct(scaled), indirect(factor) {}

  // Of one side; null: its texels hold all that is known.
  const DirectLight<D>* direct_of(bool back) const {
    return direct && (!back || direct->has_back()) ? direct : nullptr;
  }
  // What radiance_indirect says, at these strengths.
  Vec<3, float> scaled(const Vec<3, float>& light, const Field<D>& field,
                       const Vec<D>& index_position) const;
};

// Radiance of the isosurface through an index position of the field that was lit, on one of its
// sides, which the grid must hold.
template <int D>
Vec<3, float> radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                          const Vec<D>& index_position, bool back);
template <int D>
Vec<3, float> radiance_at(const RadianceGrid<D>& grid, const Field<D>& field,
                          const Vec<D>& index_position, bool back) {
  return radiance_at(ShownGrid<D>(grid), field, index_position, back);
}

// The same of an array of texels alone: linear along each axis, over the active ones only; zero
// where there is none.
template <int D>
Vec<3, float> lookup(const TexelLattice<D>& lattice, const std::vector<Vec<3, float>>& values,
                     const Vec<D>& index_position);

// At many positions, into as many places from `found` on. What is read lies far apart: it is
// fetched ahead.
template <int D>
void radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                 const std::vector<Vec<D>>& index_positions, bool back, Vec<3, float>* found);

// The standard error of such a radiance, from those of the texels, which are independent.
template <int D>
float lookup_error(const TexelLattice<D>& lattice, const std::vector<float>& errors,
                   const Vec<D>& index_position);

}  // namespace leaflight
