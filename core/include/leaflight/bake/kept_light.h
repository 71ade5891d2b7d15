// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/radiance_grid.h"
#include "leaflight/math/progress.h"
#include "leaflight/scene/scene.h"

namespace leaflight {

// What a bake in rounds that goes on keeps of those before: their indirect light, and how many
// blocks of it are averaged.
template <int D>
class KeptLight {
 public:
  // Takes numbers as a file holds them, in half precision, so that a bake goes on alike from memory
  // and from its file.
  KeptLight(RadianceGrid<D> grid, int rounds, int blocks);

  const TexelLattice<D>& lattice() const { return grid_.lattice; }
  bool has_back() const { return grid_.has_back(); }
  int rounds() const { return rounds_; }
  int blocks() const { return blocks_; }

  // What it weighs beside so many new blocks.
  float share(int blocks) const;
  // Adds its own to the variances of so many new blocks of one side, which weigh what is left.
  void add_variance(std::vector<Average>& indirect, int blocks, bool inner) const;

  // Soft light that white leaves reflect, of one side, at the texels of another lattice.
  std::vector<Rgb> soft(const Volume<D>& volume, const IsovalueWindow& window, bool inner,
                        const TexelLattice<D>& to, Progress& progress) const;

 private:
  Rgb indirect(std::size_t slot, bool inner) const;

  RadianceGrid<D> grid_;
  int rounds_, blocks_;
};

// The radiance that the leaf through an index position emits, within a window of the leaf
// coordinate.
template <int D>
Rgb emission_near(const Volume<D>& volume, const IsovalueWindow& window,
                  const Vec<D>& index_position);

}  // namespace leaflight
