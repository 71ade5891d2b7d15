// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/texels/checkpoint.h"
#include "base/parallel.h"
#include "base/release.h"
#include "base/sample_average.h"

namespace leaflight {

// Sums of weighted samples of a texel's radiance.
struct TexelSum {
  Imath::V3f radiance{0};
  float weight = 0;

  void add(const Imath::V3f& sample, float w) {
    radiance += sample * w;
    weight += w;
  }
  void add(const TexelSum& other) {
    radiance += other.radiance;
    weight += other.weight;
  }
  float mean() const { return (radiance.x + radiance.y + radiance.z) / 3; }
};

// The difference between two independent halves of a texel's samples. It holds the difference of
// the means, the first half's share of the weight, and the total weight.
struct HalfDifference {
  Imath::V3f first_less_second{0};
  float first_share = 0.5f, weight = 0;
};

// The samples of all texels of a lattice, on one side. Each block is a set of well distributed
// directions or light sources. Blocks are independent, so their differences estimate the variance
// (replicated quasi-Monte Carlo, Owen 1997).
class TexelMoments {
 public:
  explicit TexelMoments(std::size_t texels = 0) : blocks_(texels) {}

  std::vector<TexelSum> sums;  // the open block; empty after release()

  bool empty() const { return blocks_.empty(); }
  // Allows blocks to be added.
  void open() { sums.resize(blocks_.size()); }
  // Frees the memory of the open block, whose samples are lost.
  void release() { leaflight::release(sums); }
  // Closes the open block. `number`: from 0; even and odd blocks form the halves.
  void close_block(int number, Progress& progress) {
    parallel_each(sums.size(), 4096, progress,
                  [&](std::size_t i) { blocks_[i].close(sums[i], number % 2); });
  }
  // Archives the closed blocks.
  void serialize(Archive& archive) {
    const std::size_t texels = blocks_.size();
    archive(blocks_, texels);
    if (blocks_.size() != texels) {
      throw Error("The checkpoint is of another bake; bake the volume again.");
    }
  }
  std::vector<Average> averages() const {
    std::vector<Average> result(blocks_.size());
    parallel_each(result.size(), [&](std::size_t i) { result[i] = blocks_[i].average(); });
    return result;
  }
  std::vector<HalfDifference> halves() const {
    std::vector<HalfDifference> result(blocks_.size());
    parallel_each(result.size(), [&](std::size_t i) { result[i] = blocks_[i].difference(); });
    return result;
  }

 private:
  // Sums over the closed blocks.
  struct Blocks {
    std::array<TexelSum, 2> halves;
    float weight2 = 0, mixed = 0, sum2 = 0;

    void close(TexelSum& block, int half) {
      const float mean = block.mean(), w = block.weight;
      halves[half].add(block);
      weight2 += w * w;
      mixed += w * mean;
      sum2 += mean * mean;
      block = {};
    }
    Average average() const {
      TexelSum all = halves[0];
      all.add(halves[1]);
      if (!(all.weight > 0 && weight2 > 0)) return {};
      const float m = all.mean() / all.weight, all2 = all.weight * all.weight;
      // Residuals of the ratio of sums (Cochran 1977, 6.4).
      const float residuals = sum2 - 2 * m * mixed + m * m * weight2, left = 1 - weight2 / all2;
      const float variance = left > 1e-3f ? std::max(0.0f, residuals) / (all2 * left) : 0;
      return {Rgb(all.radiance / all.weight), variance, all2 / weight2};
    }
    HalfDifference difference() const {
      const TexelSum &a = halves[0], &b = halves[1];
      const float weight = a.weight + b.weight;
      if (a.weight > 0 && b.weight > 0) {
        return {a.radiance / a.weight - b.radiance / b.weight, a.weight / weight, weight};
      }
      // Light that only one half has found may be all noise.
      if (!(weight > 0)) return {};
      return {(a.radiance - b.radiance) / (0.5f * weight), 0.5f, weight};
    }
  };
  std::vector<Blocks> blocks_;

 public:
  static constexpr std::size_t bytes_a_texel = sizeof(TexelSum) + sizeof(Blocks);
};

// Moments of the front and the back; the back is empty if it is not baked.
using SideMoments = std::array<TexelMoments, 2>;

}  // namespace leaflight
