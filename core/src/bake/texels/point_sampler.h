// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/low_discrepancy.h"
#include "transport/indirect_estimator.h"
#include "transport/light_sampler.h"

namespace leaflight {

// Keys of the low-discrepancy sequences of one texel, scattered sample or vertex. All passes share
// the position key, so that they sample the same points.
struct SampleKeys {
  std::uint64_t position, light, gather, paths;
};

inline SampleKeys sample_keys(std::uint64_t seed, Purpose purpose, std::uint64_t group,
                              std::uint32_t number) {
  Random random = random_for(seed, purpose, group << 32 | number);
  return {random.bits(), random.bits(), random.bits(), random.bits()};
}

// One-sample estimates of the radiance of a point on an isosurface or a wall, for sample i of the
// keys. Each adds its number of rays to `rays`.
template <int D>
struct PointSampler {
  const LightSampler<D>& lights;
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces;
  const SurfaceCache<D>* walls;  // null: no lookups
  bool caustics;

  Rgb direct(const SurfacePoint<D>& point, const SampleKeys& keys, int i,
             std::uint64_t& rays) const {
    const double choice = lights.has_choice() ? sobol_point(i, ~keys.light)[0] : 0;
    return lights.direct_radiance(point, choice, sobol_point(i, keys.light), rays);
  }

  // Estimates all light except direct light. The estimator is null if there is no indirect light.
  Rgb indirect(const SurfacePoint<D>& point, const IndirectEstimator<D>* estimator,
               const SampleKeys& keys, int i, std::uint64_t& rays) const {
    Rgb radiance = point.emission;
    if (estimator) {
      Random random(keys.paths, 0, i);
      radiance += estimator->indirect_radiance(point, sobol_point(i, keys.gather), random, rays);
    }
    if (caustics) radiance += caustic_radiance(isosurfaces, walls, point);
    return radiance;
  }
};

}  // namespace leaflight
