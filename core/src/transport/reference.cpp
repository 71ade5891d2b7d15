// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/reference.h"

#include <cmath>

#include "base/error.h"
#include "base/low_discrepancy.h"
#include "base/parallel.h"
#include "field/given_point.h"
#include "transport/indirect_estimator.h"

namespace leaflight {
namespace {

// Traces the reference. place(tracer, i): returns surface point i, of kind none if there is none.
template <int D, class Place>
std::vector<ReferenceRadiance> trace_reference(const Scene<D>& scene, std::size_t count,
                                               const ReferenceSettings& settings,
                                               Progress& progress, Place place) {
  validate(scene);
  const SceneTracer<D> tracer(scene);
  const LightSampler<D> lights(tracer);
  const auto paths = make_path_estimator(tracer, lights);
  std::vector<ReferenceRadiance> result(count, {Rgb(0), Rgb(0)});
  const int samples = settings.samples;
  progress.expect(static_cast<double>(count));
  progress.begin("Path tracing the reference");
  parallel_range(count, 1, 1, progress, [&](std::size_t begin, std::size_t end) {
    std::uint64_t rays = 0;
    for (std::size_t p = begin; p < end; ++p) {
      const SurfacePoint<D> point = place(tracer, p);
      if (point.kind() == HitKind::none) continue;
      Random keys = random_for(settings.seed, Purpose::reference, p);
      const std::uint64_t light_key = keys.bits(), gather_key = keys.bits();
      Imath::V3d sum(0), sum2(0);
      for (int i = 0; i < samples && !progress.cancelled(); ++i) {
        Random random(keys.bits(), p, i);
        const double choice = random.uniform();
        const Rgb sample =
            lights.direct_radiance(point, choice, sobol_point(i, light_key), rays) +
            paths->indirect_radiance(point, sobol_point(i, gather_key), random, rays);
        sum += Imath::V3d(sample);
        sum2 += Imath::V3d(sample) * Imath::V3d(sample);
      }
      const Imath::V3d mean = sum / samples;
      result[p].radiance = Rgb(mean) + point.emission;
      for (int c = 0; c < 3 && samples > 1; ++c) {
        const double variance = std::max(0.0, sum2[c] / samples - mean[c] * mean[c]);
        result[p].standard_error[c] = static_cast<Real>(std::sqrt(variance / (samples - 1)));
      }
    }
  });
  return result;
}

}  // namespace

template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<Vec<D>>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress) {
  if (settings.volume < 0 || settings.volume >= static_cast<int>(scene.volumes.size())) {
    throw Error("There is no volume of number " + std::to_string(settings.volume) +
                " in the scene; it has " + std::to_string(scene.volumes.size()) + ".");
  }
  const Field<D>& field = scene.volumes[settings.volume].field;
  return trace_reference<D>(scene, points.size(), settings, progress,
                            [&](const SceneTracer<D>& tracer, std::size_t p) -> SurfacePoint<D> {
                              const Vec<D> index = field.world_to_index.point(points[p]);
                              if (!holds_given(field, index)) return {};
                              return tracer.isosurface_point(settings.volume, locate(field, index),
                                                             settings.c, settings.back);
                            });
}

template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<FacetPoint>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress) {
  for (const FacetPoint& p : points) {
    if (p.mesh < 0 || p.mesh >= static_cast<int>(scene.meshes.size()) || p.facet < 0 ||
        p.facet >= static_cast<int>(scene.meshes[p.mesh].facets.size())) {
      throw Error("There is no face " + std::to_string(p.facet) + " of a mesh of number " +
                  std::to_string(p.mesh) + " in the scene; choose another.");
    }
  }
  return trace_reference<D>(
      scene, points.size(), settings, progress, [&](const SceneTracer<D>& tracer, std::size_t i) {
        const FacetPoint& p = points[i];
        return tracer.facet_point(p.mesh, p.facet, p.u, p.v, p.front, settings.c);
      });
}

template std::vector<ReferenceRadiance> reference_radiance<2>(const Scene<2>&,
                                                              const std::vector<Vec<2>>&,
                                                              const ReferenceSettings&, Progress&);
template std::vector<ReferenceRadiance> reference_radiance<3>(const Scene<3>&,
                                                              const std::vector<Vec<3>>&,
                                                              const ReferenceSettings&, Progress&);
template std::vector<ReferenceRadiance> reference_radiance<2>(const Scene<2>&,
                                                              const std::vector<FacetPoint>&,
                                                              const ReferenceSettings&, Progress&);
template std::vector<ReferenceRadiance> reference_radiance<3>(const Scene<3>&,
                                                              const std::vector<FacetPoint>&,
                                                              const ReferenceSettings&, Progress&);

}  // namespace leaflight
