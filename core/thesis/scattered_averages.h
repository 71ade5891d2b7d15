// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thesis/fixed_settings.h"
#include "thesis/isosurface_averages.h"

namespace leaflight {

// Returns averages for every active texel, like average_texels(). Interpolates the mean radiances
// at index positions into the texels.
template <int D, class Radiance>
std::vector<Average> average_scattered(const SceneTracer<D>& tracer, const TexelLattice<D>& lattice,
                                       const IsosurfaceSamples& samples,
                                       const std::vector<Vec<D>>& positions,
                                       const ScatteredSettings& filter, Progress& progress,
                                       Radiance radiance) {
  const Volume<D>& scene_volume = tracer.scene().volumes[samples.volume];
  std::vector<Rgb> values(positions.size(), Rgb(0));
  parallel_range(
      positions.size(), texels_per_piece, samples.rays_per_sample * samples.count, progress,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t traced = 0;
        for (std::size_t s = begin; s < end && !progress.cancelled(); ++s) {
          const CellPoint<D> at = locate(scene_volume.field, positions[s]);
          const double h = interpolate(load_corners(scene_volume.field, at.cell), at.local);
          const SurfacePoint<D> point = tracer.isosurface_point(
              samples.volume, at, scene_volume.common_isovalue(h), samples.back);
          if (point.kind() == HitKind::none) continue;
          const SampleKeys keys = sample_keys(samples.seed, Purpose::scattered, samples.volume,
                                              static_cast<std::uint32_t>(s));
          Imath::V3d sum(0);
          for (int i = 0; i < samples.count; ++i) {
            sum += Imath::V3d(radiance(point, keys, i, traced));
          }
          values[s] = Rgb(sum / samples.count);
        }
        progress.count_rays(traced);
      });
  const ScatteredTexels texels =
      interpolate_scattered(lattice, positions, values, filter, progress);
  std::vector<Average> averages;
  for (std::size_t s = 0; s < texels.value.size(); ++s) {
    averages.push_back({texels.value[s], texels.error[s] * texels.error[s], 1});
  }
  return averages;
}

}  // namespace leaflight
