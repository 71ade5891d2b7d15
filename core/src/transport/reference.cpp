// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/reference.h"

#include <cmath>

#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/parallel.h"
#include "leaflight/transport/indirect_estimator.h"

namespace leaflight {

template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<Vec<D>>& points,
                                                  double isovalue, int samples, std::uint64_t seed,
                                                  Progress& progress) {
  validate(scene);
  const SceneTracer<D> tracer(scene);
  const LightSampler<D> lights(tracer);
  const auto paths = make_path_estimator(tracer, lights);
  std::vector<ReferenceRadiance> result(points.size(), {Rgb(0), Rgb(0)});
  progress.expect(static_cast<double>(points.size()));
  progress.begin("Path tracing the reference");
  parallel_range(points.size(), 1, 1, progress, [&](std::size_t begin, std::size_t end) {
    std::uint64_t rays = 0;
    for (std::size_t p = begin; p < end; ++p) {
      const Vec<D> index = scene.field.world_to_index.point(points[p]);
      if (!inside(scene.field, index)) continue;
      const SurfacePoint<D> point = tracer.leaf_point(locate(scene.field, index), isovalue, false);
      if (point.kind == HitKind::none) continue;
      Random keys = random_for(seed, Purpose::reference, p);
      const std::uint64_t light_key = keys.bits(), gather_key = keys.bits();
      Imath::V3d sum(0), sum2(0);
      for (int i = 0; i < samples && !progress.cancelled(); ++i) {
        Random random(keys.bits(), p, i);
        const Rgb sample =
            lights.direct_radiance(point, random.uniform(), sobol_point(i, light_key), rays) +
            paths->indirect_radiance(point, sobol_point(i, gather_key), random, rays);
        sum += Imath::V3d(sample);
        sum2 += Imath::V3d(sample) * Imath::V3d(sample);
      }
      const Imath::V3d mean = sum / samples;
      result[p].radiance = Rgb(mean);
      for (int c = 0; c < 3 && samples > 1; ++c) {
        const double variance = std::max(0.0, sum2[c] / samples - mean[c] * mean[c]);
        result[p].standard_error[c] = static_cast<Real>(std::sqrt(variance / (samples - 1)));
      }
    }
  });
  return result;
}

template std::vector<ReferenceRadiance> reference_radiance<2>(const Scene<2>&,
                                                              const std::vector<Vec<2>>&, double,
                                                              int, std::uint64_t, Progress&);
template std::vector<ReferenceRadiance> reference_radiance<3>(const Scene<3>&,
                                                              const std::vector<Vec<3>>&, double,
                                                              int, std::uint64_t, Progress&);

}  // namespace leaflight
