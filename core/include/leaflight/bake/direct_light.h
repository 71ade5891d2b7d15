// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/direct_sweep.h"
#include "leaflight/transport/light_sampler.h"

namespace leaflight {

// Direct light of the leaves of one volume at the texels of a lattice, by sweeps from points of the
// luminaires, in blocks.
template <int D>
class DirectLight {
 public:
  static constexpr int sources_per_block = 8;

  DirectLight(const SweptVolume<D>& volume, const LightSampler<D>& lights,
              const SweptLattice<D>& texels, bool inner, std::uint64_t seed);

  void add_block(Progress& progress, std::atomic<std::uint64_t>& lines);
  int blocks() const { return blocks_; }
  // What a block costs, in points of lines.
  double cost() const;

  std::vector<Average> averages(bool inner) const;
  // Of the first sources.
  const LeafShadows<D>& shadows() const { return shadows_; }

 private:
  static constexpr int most_shadows = 8;

  SweptVolume<D> volume_;
  const LightSampler<D>& lights_;
  const SweptLattice<D>& texels_;
  std::uint64_t seed_;
  SideMoments moments_;
  LeafShadows<D> shadows_;
  int blocks_ = 0;
};

}  // namespace leaflight
