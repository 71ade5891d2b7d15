// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "leaflight/bake/sample_average.h"
#include "leaflight/field/texel_lattice.h"

namespace leaflight {

// What one bake says of the leaves of one volume: radiance [W/(m^2 sr)] at the active texels, in
// the order of `lattice.active`.
template <int D>
struct RadianceGrid {
  TexelLattice<D> lattice;
  // The outer side.
  std::vector<Vec<3, float>> radiance;
  std::vector<Vec<3, float>> radiance_indirect;  // all of it but the lights' direct light
  std::vector<float> radiance_error;             // standard error of the mean over the channels
  // The inner side; empty where it was not baked.
  std::vector<Vec<3, float>> radiance_back;
  // Texels of half the width, which serve some cells instead; null: none do.
  std::shared_ptr<RadianceGrid> finer;

  // Active ones, of all levels.
  std::size_t texels() const { return lattice.active.size() + (finer ? finer->texels() : 0); }
  bool has_back() const { return !radiance_back.empty(); }
  // The finest grid that serves an index position.
  const RadianceGrid& at(const Vec<D>& index_position) const;
};

// Averages of the outer and the inner side; the latter's are empty where it is not baked.
using SideAverages = std::array<std::vector<Average>, 2>;

// The grid without its lattice, from averages of the active texels.
template <int D>
RadianceGrid<D> make_grid(const SideAverages& direct, const SideAverages& indirect);

// Linear along each axis, over the active texels only; zero where there is none.
template <int D>
Vec<3, float> lookup(const TexelLattice<D>& lattice, const std::vector<Vec<3, float>>& values,
                     const Vec<D>& index_position);

// The standard error of such a radiance, from those of the texels, which are independent.
template <int D>
float lookup_error(const TexelLattice<D>& lattice, const std::vector<float>& errors,
                   const Vec<D>& index_position);

}  // namespace leaflight
