// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/indirect/gather_lines.h"
#include "bake/texels/texel_moments.h"

namespace leaflight {

// Indirect light on the isosurfaces of one volume as if they were white, at the texels of a
// lattice. Blocks of line passes compute it. Its lattice may be coarser than that of direct light,
// because indirect light varies less.
template <int D>
class IndirectLight {
 public:
  static constexpr int directions_per_block = 32;

  // `spacing`: of the lines, in texels; each texel then receives one of spacing^(D - 1) directions.
  // `first_block`: number of blocks of this seed that a previous bake has used.
  IndirectLight(const LineVolume<D>& volume, IndexedLattice<D> texels, int spacing, bool back,
                std::uint64_t seed, int first_block = 0);

  const IndexedLattice<D>& texels() const { return texels_; }

  // Adds a block of directions, given the light to look up. All blocks of an average must have the
  // same number of directions.
  void add_block(const GatheredRadiance<D>& from, Progress& progress,
                 int directions = directions_per_block);
  // Adds a block whose sums `fill` computes.
  void add_block_by(const std::function<void(SideMoments&)>& fill, Progress& progress);
  // Traces a block for another process, and adds one from there, which is block next_block().
  std::string traced_block(int number, const GatheredRadiance<D>& from, Progress& progress);
  void add_traced(const std::string& bytes, Progress& progress);
  int next_block() const { return drawn_; }
  void go_to_block(int number) { drawn_ = number; }
  // Frees the data that only blocks need, until the next block.
  void release();
  // Serializes the state between two blocks.
  void serialize(Archive& archive);
  int blocks() const { return blocks_; }
  // Returns the work of a block, in the unit of the progress: points of lines.
  double cost() const { return cost(texels_.lattice, spacing_); }
  static double cost(const TexelLattice<D>& texels, int spacing);
  // Starts again with other directions.
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

// Interpolates averages at the texels of a lattice, at a texel of another one.
template <int D>
Average interpolated(const TexelLattice<D>& from, const std::vector<Average>& averages,
                     const TexelLattice<D>& to, std::size_t slot);

}  // namespace leaflight
