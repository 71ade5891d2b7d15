// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "leaflight/bake/block_workers.h"
#include "leaflight/bake/direct_sweep.h"
#include "leaflight/transport/light_sampler.h"

namespace leaflight {

// Direct light of the leaves of one volume at the texels of a lattice, by sweeps from points of the
// luminaires, in blocks.
template <int D>
class DirectLight {
 public:
  static constexpr int sources_per_block = 8;

  // `first_block`: how many blocks of the seed others have drawn.
  DirectLight(const SweptVolume<D>& volume, const LightSampler<D>& lights,
              const SweptLattice<D>& texels, bool inner, std::uint64_t seed, int first_block = 0);

  // after_block, if given, is called after each of them. The first block is swept here, and others
  // by the workers, if there are any.
  void add_blocks(int count, Progress& progress, std::atomic<std::uint64_t>& lines,
                  const std::function<void()>& after_block = {},
                  const BlockWorkers* workers = nullptr);
  // A block of this number for another that has asked for it, as block_bytes().
  std::string sweep_for_others(int number, Progress& progress);
  // Its state between two blocks. What the first sources told is not in it, but learnt anew.
  void keep(Keeper& keeper, Progress& progress);
  // What the sources of a block, the same one always, tell leaf_light().
  void learn_leaf_light(int block, Progress& progress);
  int first_block() const { return first_block_; }
  int blocks() const { return blocks_; }
  // What a block costs, in points of lines.
  double cost() const;

  std::vector<Average> averages(bool inner) const;
  // Of the sources of the first block.
  const LeafLight<D>& leaf_light() const { return leaf_light_; }

 private:
  void sweep(int block, Progress& progress, std::atomic<std::uint64_t>& lines, SideMoments& moments,
             LeafLight<D>* leaf_light);

  SweptVolume<D> volume_;
  const LightSampler<D>& lights_;
  const SweptLattice<D>& texels_;
  std::uint64_t seed_;
  SideMoments moments_;
  LeafLight<D> leaf_light_;
  int first_block_, blocks_ = 0;
};

}  // namespace leaflight
