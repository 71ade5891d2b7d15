// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/low_discrepancy.h"
#include "transport/indirect_estimator.h"
#include "transport/light_sampler.h"

namespace leaflight {

// Keys of the low-discrepancy sequences of one texel, scattered sample or vertex; the position key
// is shared by all passes, so that they see the same points.
struct SampleKeys {
  std::uint64_t position, light, gather, paths;
};

inline SampleKeys sample_keys(std::uint64_t seed, Purpose purpose, std::uint64_t group,
                              std::uint32_t number) {
  Random random = random_for(seed, purpose, group << 32 | number);
  return {random.bits(), random.bits(), random.bits(), random.bits()};
}

// One-sample estimates, number i of the keys, of the radiance of a point, of an isosurface or of
// the walls. Each adds the rays it traces to `rays`.
template <int D>
struct PointSampler {
  const LightSampler<D>& lights;
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces;
  const SurfaceCache<D>* walls;  // null if nothing looks it up
  bool caustics;

  Rgb direct(const SurfacePoint<D>& point, const SampleKeys& keys, int i,
             std::uint64_t& rays) const {
    const double choice = lights.has_choice() ? sobol_point(i, ~keys.light)[0] : 0;
    return lights.direct_radiance(point, choice, sobol_point(i, keys.light), rays);
  }

  // All but direct light; the estimator may be null where there is no indirect light.
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
