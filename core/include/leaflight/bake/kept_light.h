// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/radiance_grid.h"
#include "leaflight/math/progress.h"
#include "leaflight/scene/scene.h"

namespace leaflight {

// What a bake in rounds that goes on keeps of those before: their radiance, and how many blocks of
// direct and of indirect light are averaged in it.
template <int D>
class KeptLight {
 public:
  // Takes numbers as a file holds them, in half precision, so that a bake goes on alike from memory
  // and from its file.
  KeptLight(RadianceGrid<D> grid, int rounds, int direct_blocks, int indirect_blocks);

  const TexelLattice<D>& lattice() const { return grid_.lattice; }
  bool has_back() const { return grid_.has_back(); }
  int rounds() const { return rounds_; }
  int direct_blocks() const { return direct_blocks_; }
  int indirect_blocks() const { return indirect_blocks_; }

  // Averages so many new blocks with those kept, of one side, at all texels; those without a sample
  // have been given their neighbours' light (pooled_variance.h). The error kept is that of direct
  // and indirect light together; it is divided as that of new blocks is.
  void add_to(std::vector<Average>& direct, int direct_blocks, std::vector<Average>& indirect,
              int indirect_blocks, bool inner) const;
  // The same of direct light's means alone, before that.
  void add_to_direct(std::vector<Average>& direct, int blocks, bool inner) const;

  // Soft light that white leaves reflect, of one side, at the texels of another lattice.
  std::vector<Rgb> soft(const Volume<D>& volume, const IsovalueWindow& window, bool inner,
                        const TexelLattice<D>& to, Progress& progress) const;

 private:
  Rgb direct(std::size_t slot, bool inner) const;
  Rgb indirect(std::size_t slot, bool inner) const;

  RadianceGrid<D> grid_;
  int rounds_, direct_blocks_, indirect_blocks_;
};

// What kept blocks weigh beside new ones in a texel; kept ones alone count where new ones found no
// sample.
float kept_share(const Average& found, int blocks, int kept);

// The radiance that the leaf through an index position emits, within a window of the leaf
// coordinate.
template <int D>
Rgb emission_near(const Volume<D>& volume, const IsovalueWindow& window,
                  const Vec<D>& index_position);

}  // namespace leaflight
