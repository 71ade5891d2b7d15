// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "bake/texels/point_sampler.h"
#include "bake/texels/pooled_variance.h"
#include "bake/texels/texel_samples.h"
#include "base/parallel.h"
#include "thesis/moments.h"

namespace leaflight {

// Samples of the radiance on one side of a volume's isosurfaces: `count` in each texel, or at each
// of some scattered points.
struct IsosurfaceSamples {
  int volume;
  bool back;
  int count;
  double rays_per_sample;  // expected number of rays
  std::uint64_t seed;
};

inline constexpr std::size_t texels_per_piece = 64;
// Number of blocks in which a texel's samples are averaged (see Moments).
inline constexpr int blocks_per_texel = 4;

// Averages radiance(point, keys, i, rays) over the samples of every active texel. The weight |grad
// c| dV = dA dc makes it a mean over the area of the isosurfaces, which lookups see. Otherwise
// noise in flat parts of the field would count as much as surfaces, which are steep.
template <int D, class Radiance>
std::vector<Average> average_texels(const SceneTracer<D>& tracer, const TexelLattice<D>& lattice,
                                    const IsosurfaceSamples& samples, Progress& progress,
                                    Radiance radiance) {
  struct Drawn {
    Rgb radiance;
    double weight;
  };
  std::vector<Average> averages(lattice.active.size());
  parallel_range(
      averages.size(), texels_per_piece, samples.rays_per_sample * samples.count, progress,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t traced = 0;
        std::vector<Drawn> drawn;
        for (std::size_t s = begin; s < end && !progress.cancelled(); ++s) {
          const std::uint32_t texel = lattice.active[s];
          const SampleKeys keys = sample_keys(samples.seed, Purpose::texel, samples.volume, texel);
          drawn.clear();
          for_each_texel_sample(tracer, samples.volume, samples.back, lattice, texel, samples.count,
                                keys.position, [&](const SurfacePoint<D>& point, int i) {
                                  drawn.push_back({radiance(point, keys, i, traced),
                                                   point.isosurface().gradient_length});
                                });
          // There may be fewer samples than requested.
          Moments moments(static_cast<int>(drawn.size()) / blocks_per_texel);
          for (const Drawn& d : drawn) moments.add(d.radiance, d.weight);
          averages[s] = moments.average();
        }
        progress.count_rays(traced);
      });
  pool_variances(lattice, averages, progress);
  return averages;
}

}  // namespace leaflight
