// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/filtered_light.h"
#include "bake/output/radiance_grid.h"

namespace leaflight {

// Indirect light of a previous bake in passes, and the number of blocks in its average.
template <int D>
class PreviousLight {
 public:
  PreviousLight(const RadianceGrid<D>& grid, int passes, int blocks);

  // True if it has these texels of the result and of indirect light.
  bool fits(const TexelLattice<D>& shown, const TexelLattice<D>& indirect, bool back) const;
  const Index<D>& resolution() const { return resolution_; }  // of the result
  int passes() const { return passes_; }
  int blocks() const { return blocks_; }

  // Averages one side's light of `blocks` new blocks with the previous light. If halves are known,
  // each light is one half of the result.
  void blend(NoisyLight& light, int blocks, bool back) const;

 private:
  // Returns the weight of the previous light. `now`: average of the new blocks.
  float share(std::size_t slot, const Average& now, int blocks, bool back) const;

  Index<D> resolution_;
  std::vector<std::uint32_t> active_;
  Index<D> indirect_resolution_;
  std::vector<std::uint32_t> indirect_texels_;
  std::array<std::vector<Vec<3, float>>, 2> sides_;
  int passes_, blocks_;
};

}  // namespace leaflight
