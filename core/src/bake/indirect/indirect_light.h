// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/block_workers.h"
#include "bake/indirect/gather_lines.h"

namespace leaflight {

// Indirect light on the isosurfaces of one volume as if they were white, at the texels of a
// lattice, by line passes, in blocks. Its lattice may be coarser than that of direct
// light: indirect light varies less, and each direction then costs less.
template <int D>
class IndirectLight {
 public:
  static constexpr int directions_per_block = 32;

  // `spacing`: of the lines, in texels; each texel then takes one of spacing^(D - 1) directions.
  // `first_block`: how many blocks of the seed others have drawn.
  IndirectLight(const LineVolume<D>& volume, IndexedLattice<D> texels, int spacing, bool back,
                std::uint64_t seed, int first_block = 0);

  const IndexedLattice<D>& texels() const { return texels_; }

  // One block of directions, given the light to look up; all blocks that are averaged have as many.
  void add_block(const GatheredRadiance<D>& from, Progress& progress,
                 int directions = directions_per_block);
  // One of which fill() makes the open sums.
  void add_block_by(const std::function<void(SideMoments&)>& fill, Progress& progress);
  // One that a BlockTracer has traced, as block_bytes(); its number is next_block().
  void add_block_of_others(const std::string& bytes, Progress& progress);
  int next_block() const { return drawn_; }
  // A block of this number for another that has asked for it.
  std::string traced_block(int number, const GatheredRadiance<D>& from, Progress& progress);
  // Frees what only blocks need, until the next.
  void release();
  // Its state between two blocks.
  void serialize(Archive& archive);
  int blocks() const { return blocks_; }
  // What a block costs, in points of lines.
  double cost() const { return cost(texels_.lattice, spacing_); }
  static double cost(const TexelLattice<D>& texels, int spacing);
  // Begins anew, with other directions.
  void clear();

  std::vector<Average> averages(bool back) const;
  std::vector<HalfDifference> halves(bool back) const;

 private:
  // Returns the number of lines.
  std::uint64_t trace(int number, const GatheredRadiance<D>& from, Progress& progress,
                      int directions);
  void close_block(Progress& progress);

  LineVolume<D> volume_;
  IndexedLattice<D> texels_;
  int spacing_;
  std::uint64_t seed_;
  int sides_;
  SideMoments moments_;
  int blocks_ = 0, drawn_;
};

// Averages known at the texels of one lattice, interpolated at those of another.
template <int D>
std::vector<Average> interpolated(const TexelLattice<D>& from, const std::vector<Average>& averages,
                                  const TexelLattice<D>& to, Progress& progress);

}  // namespace leaflight
