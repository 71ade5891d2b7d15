// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/filtered_light.h"
#include "bake/output/radiance_grid.h"

namespace leaflight {

// What a bake in passes that goes on keeps of those before: their indirect light, and how many
// blocks of it are averaged.
template <int D>
class PreviousLight {
 public:
  // Takes numbers as a file holds them, in half precision, so that a bake goes on alike from memory
  // and from its file.
  PreviousLight(const RadianceGrid<D>& grid, int passes, int blocks);

  // Whether it is of these texels, of the result and of indirect light.
  bool fits(const TexelLattice<D>& shown, const TexelLattice<D>& indirect, bool back) const;
  const Index<D>& resolution() const { return resolution_; }  // of the result
  int passes() const { return passes_; }
  int blocks() const { return blocks_; }

  // The mean of one side's light of so many new blocks and of the previous, each a half of it
  // if halves are known.
  void blend(NoisyLight& light, int blocks, bool back) const;

 private:
  // Of previous light, where new blocks found `now`.
  float share(std::size_t slot, const Average& now, int blocks, bool back) const;

  Index<D> resolution_;
  std::vector<std::uint32_t> active_;
  UnfilteredLight<D> light_;
  int passes_, blocks_;
};

}  // namespace leaflight
