// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/filtered_light.h"

#include <cmath>

#include "bake/texels/texel_neighbors.h"
#include "base/parallel.h"
#include "base/release.h"

namespace leaflight {
namespace {

constexpr std::size_t grain = 2048;
// A step of the filter. Neighbors are `reach` texels away (a trous, Dammertz et al. 2010), on about
// the same isosurface or across to the next.
struct Step {
  int reach;
  bool across;
};
constexpr std::array<Step, 3> steps{{{1, false}, {2, false}, {1, true}}};
// Distance in texels at which the weight of another isosurface is a quarter.
constexpr float quarter_distance = 0.75f;

// The light of a texel and the difference of its halves, adjacent in memory for reads of neighbors.
struct Texel {
  Rgb light;
  HalfDifference halves;
};

std::vector<Texel> texels_of(const NoisyLight& light) {
  std::vector<Texel> texels(light.averages.size());
  parallel_each(texels.size(), [&](std::size_t s) {
    texels[s] = {light.averages[s].mean, light.halves[s]};
  });
  return texels;
}

// The mean of a texel's neighbors minus the texel, for its light and for the difference of its
// halves.
struct Offset {
  Imath::V3f light{0}, halves{0};
};

template <int D>
float likeness(const TexelSurface<D>& a, const TexelSurface<D>& b, bool across) {
  const float cosine = a.normal.dot(b.normal);
  if (!(cosine > 0)) return 0;
  const float square = cosine * cosine;
  if (across) return square * square;
  const float distance =
      (a.value - b.value) / (0.5f * (a.steepness + b.steepness) * quarter_distance);
  const float far = 1 + distance * distance;
  return square * square / (far * far);
}

template <int D>
Offset offset_of(const TexelNeighbors<D>& neighbors, const std::vector<TexelSurface<D>>& surfaces,
                 const std::vector<Texel>& texels, bool across, std::size_t slot) {
  const Texel& center = texels[slot];
  Offset sum;
  float weights = center.halves.weight;
  neighbors.for_each(slot, [&](std::size_t s, float place) {
    const Texel& one = texels[s];
    const float weight = place * likeness(surfaces[slot], surfaces[s], across) * one.halves.weight;
    weights += weight;
    sum.light += Imath::V3f(one.light - center.light) * weight;
    sum.halves += (one.halves.first_less_second - center.halves.first_less_second) * weight;
  });
  const float weight = weights > 0 ? weights : 1;
  return {sum.light / weight, sum.halves / weight};
}

// Returns the mean square of three channels.
float square(const Imath::V3f& x) { return x.length2() / 3; }

// Returns the variance of the mean of two halves, given their difference.
float noise_of(const Imath::V3f& difference, float first_share) {
  return square(difference) * first_share * (1 - first_share);
}

// Two numbers of a texel times its weight, the weight, and 1. Without weights, the noise of texels
// with few samples would dominate. Aligned for SIMD sums.
struct alignas(16) Weighed {
  float first = 0, second = 0, weight = 0, places = 0;
};
Weighed weighed(float first, float second, float weight) {
  return {weight * first, weight * second, weight, 1};
}
template <int D>
Weighed sums_about(const TexelNeighbors<D>& neighbors, const std::vector<Weighed>& values,
                   std::size_t slot) {
  Weighed sums = values[slot];
  neighbors.for_each(slot, [&](std::size_t s, float place) {
    sums.first += place * values[s].first;
    sums.second += place * values[s].second;
    sums.weight += place * values[s].weight;
    sums.places += place * values[s].places;
  });
  return sums;
}

// Moves texels towards the mean of their neighbors. Updates the variances of `averages`.
template <int D>
void shrink(const TexelNeighbors<D>& neighbors, const std::vector<Offset>& offsets,
            std::vector<Texel>& texels, std::vector<Average>& averages, Progress& progress) {
  const std::size_t count = texels.size();
  // `changes`: squared offsets, and their part by noise. `noise`: noise of texels before and after.
  std::vector<Weighed> changes(count), noise(count);
  parallel_each(count, grain, progress, [&](std::size_t s) {
    const HalfDifference& halves = texels[s].halves;
    changes[s] = weighed(square(offsets[s].light), noise_of(offsets[s].halves, halves.first_share),
                         halves.weight);
  });
  std::vector<float> bias(count);
  parallel_each(count, grain, progress, [&](std::size_t s) {
    const Weighed about = sums_about(neighbors, changes, s);
    HalfDifference& halves = texels[s].halves;
    // The noise of a texel decreases with its samples; the light does not.
    const float by_noise = about.second / about.places;
    const float by_light = about.weight > 0 ? (about.first - about.second) / about.weight : 0;
    const float signal = std::max(0.0f, by_light) * halves.weight;
    const float share = by_noise > 0 ? by_noise / (by_noise + signal) : 0;
    bias[s] = share * share * (1 - share) * square(offsets[s].light);
    const float before = noise_of(halves.first_less_second, halves.first_share);
    halves.first_less_second += offsets[s].halves * share;
    noise[s] =
        weighed(before, noise_of(halves.first_less_second, halves.first_share), halves.weight);
    texels[s].light += Rgb(offsets[s].light * share);
  });
  parallel_each(count, grain, progress, [&](std::size_t s) {
    float& variance = averages[s].variance;
    const Weighed about = sums_about(neighbors, noise, s);
    if (about.first > 0) variance *= std::min(1.0f, about.second / about.first);
    variance += bias[s];
  });
}

}  // namespace

template <int D>
void filter_along_isosurfaces(const IndexedLattice<D>& texels,
                              const std::vector<TexelSurface<D>>& surfaces,
                              std::array<NoisyLight, 2>& sides, Progress& progress) {
  for (NoisyLight& light : sides) {
    if (light.averages.empty()) continue;
    std::vector<Texel> filtered = texels_of(light);
    release(light.halves);
    std::vector<Offset> offsets(filtered.size());
    for (const Step& step : steps) {
      const TexelNeighbors<D> neighbors(texels, step.reach);
      parallel_each(filtered.size(), grain, progress, [&](std::size_t s) {
        offsets[s] = offset_of(neighbors, surfaces, filtered, step.across, s);
      });
      shrink(neighbors, offsets, filtered, light.averages, progress);
    }
    parallel_each(filtered.size(),
                  [&](std::size_t s) { light.averages[s].mean = filtered[s].light; });
  }
}

template void filter_along_isosurfaces<2>(const IndexedLattice<2>&,
                                          const std::vector<TexelSurface<2>>&,
                                          std::array<NoisyLight, 2>&, Progress&);
template void filter_along_isosurfaces<3>(const IndexedLattice<3>&,
                                          const std::vector<TexelSurface<3>>&,
                                          std::array<NoisyLight, 2>&, Progress&);

}  // namespace leaflight
