// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/indirect_light.h"

#include <algorithm>
#include <cmath>

#include "bake/plan/shared_parts.h"
#include "base/low_discrepancy.h"
#include "base/sampling.h"
#include "field/cap_layers.h"

namespace leaflight {
namespace {

// Returns a uniform direction of a hemisphere; each line serves two directions.
template <int D>
Vec<D> line_direction(const std::array<double, 2>& u) {
  Vec<D> axis(0.0);
  axis[D - 1] = 1;
  return sample_cone<D>(axis, 1, u);
}

}  // namespace

template <int D>
IndirectLight<D>::IndirectLight(const LineVolume<D>& volume, IndexedLattice<D> texels, int spacing,
                                bool back, std::uint64_t seed, int first_block)
    : volume_(volume),
      texels_(std::move(texels)),
      spacing_(spacing),
      seed_(seed),
      sides_(back ? 2 : 1),
      drawn_(first_block) {
  clear();
}

template <int D>
void IndirectLight<D>::clear() {
  blocks_ = 0;
  for (int side = 0; side < sides_; ++side) {
    // Free the old moments before the allocation of new ones.
    moments_[side] = TexelMoments();
    moments_[side] = TexelMoments(texels_.lattice.active.size());
  }
}

template <int D>
void IndirectLight<D>::add_block(const GatheredRadiance<D>& from, Progress& progress,
                                 int directions) {
  progress.count_rays(trace(drawn_, from, progress, directions));
  close_block(progress);
}

template <int D>
void IndirectLight<D>::add_block_by(const std::function<void(SideMoments&)>& fill,
                                    Progress& progress) {
  for (TexelMoments& side : moments_) side.open();
  fill(moments_);
  close_block(progress);
}

template <int D>
std::string IndirectLight<D>::traced_block(int number, const GatheredRadiance<D>& from,
                                           Progress& progress) {
  progress.count_rays(trace(number, from, progress, directions_per_block));
  std::string bytes = bytes_of(moments_[0].sums);
  if (sides_ == 2) bytes += bytes_of(moments_[1].sums);
  release();
  return bytes;
}

template <int D>
void IndirectLight<D>::add_traced(const std::string& bytes, Progress& progress) {
  add_block_by(
      [&](SideMoments& moments) {
        std::size_t at = 0;
        for (TexelMoments& side : moments) {
          copy_items(bytes, at, side.sums.data(), side.sums.size());
          at += side.sums.size() * sizeof(TexelSum);
        }
        if (at != bytes.size()) throw SharedParts::other_bake();
      },
      progress);
}

template <int D>
void IndirectLight<D>::release() {
  for (TexelMoments& side : moments_) side.release();
}

template <int D>
std::uint64_t IndirectLight<D>::trace(int number, const GatheredRadiance<D>& from,
                                      Progress& progress, int directions) {
  for (TexelMoments& side : moments_) side.open();
  Random random = random_for(seed_, Purpose::gather_lines, number);
  const std::uint64_t direction_key = random.bits(), offset_key = random.bits();
  std::uint64_t lines = 0;
  for (int i = 0; i < directions; ++i) {
    lines +=
        gather_along_lines(volume_, texels_, from, line_direction<D>(sobol_point(i, direction_key)),
                           spacing_, sobol_point(i, offset_key), random.bits(), progress, moments_);
    progress.advance(cost() / directions_per_block);
  }
  return lines;
}

template <int D>
void IndirectLight<D>::close_block(Progress& progress) {
  for (TexelMoments& side : moments_) side.close_block(blocks_, progress);
  ++blocks_;
  ++drawn_;
}

template <int D>
void IndirectLight<D>::serialize(Archive& archive) {
  archive(blocks_);
  archive(drawn_);
  for (TexelMoments& side : moments_) side.serialize(archive);
}

template <int D>
double IndirectLight<D>::cost(const TexelLattice<D>& texels, int spacing) {
  // Lines are one texel apart; along a line, the work is proportional to the planes of voxels.
  const double planes = std::max(1.0, texels.voxels_per_texel[0]);
  return static_cast<double>(texels.texels()) * planes * directions_per_block /
         std::pow(spacing, D - 1);
}

template <int D>
std::vector<Average> IndirectLight<D>::averages(bool back) const {
  return moments_[back].averages();
}

template <int D>
std::vector<HalfDifference> IndirectLight<D>::halves(bool back) const {
  return moments_[back].halves();
}

template <int D>
Average interpolated(const TexelLattice<D>& from, const std::vector<Average>& averages,
                     const TexelLattice<D>& to, std::size_t slot) {
  // Photons have no layers.
  if (from.resolution == to.resolution && slot < averages.size()) return averages[slot];
  Average result;
  float error = 0;
  TexelWeights<D> near = linear_weights(from, to.center(to.active[slot]));
  const int layer = to.layer(slot);
  if (layer >= 0) near = layer_weights(from, near, to.layer_value(layer));
  for (int i = 0; i < near.count; ++i) {
    const Average& texel = averages[near.slot[i]];
    result.mean += texel.mean * near.weight[i];
    // Texels on the same lines have correlated errors.
    error += near.weight[i] * std::sqrt(texel.variance);
    result.samples = std::max(result.samples, texel.samples);
  }
  result.variance = error * error;
  return result;
}

template class IndirectLight<2>;
template class IndirectLight<3>;
template Average interpolated<2>(const TexelLattice<2>&, const std::vector<Average>&,
                                 const TexelLattice<2>&, std::size_t);
template Average interpolated<3>(const TexelLattice<3>&, const std::vector<Average>&,
                                 const TexelLattice<3>&, std::size_t);

}  // namespace leaflight
