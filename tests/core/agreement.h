// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes.h"
#include "surface/marching_cubes.h"
#include "surface/project.h"
#include "thesis/fixed_samples.h"
#include "transport/reference.h"

namespace leaflight::test {

// True in builds with sanitizers, which are about ten times slower. Such builds trace fewer photons
// and paths, and skip statistical tests.
#ifdef LEAFLIGHT_SANITIZE
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
constexpr int fewer(int count) { return sanitized ? std::max(2, count / 32) : count; }

template <int D>
FixedSettings<D> fixed_settings(EstimatorName estimator, int samples, int photons) {
  FixedSettings<D> settings;
  settings.samples = samples;
  settings.photons = settings.caustic_photons = photons;
  settings.estimator = estimator;
  return settings;
}

template <int D>
Baked<D> baked(const Scene<D>& scene, const FixedSettings<D>& settings) {
  Progress progress;
  return bake_with_fixed_samples(scene, settings, progress);
}

// Returns path-traced radiance at points of the isosurface c or of meshes.
template <int D, class Point>
std::vector<ReferenceRadiance> traced(const Scene<D>& scene, const std::vector<Point>& points,
                                      double c, int samples, std::uint64_t seed) {
  Progress progress;
  return reference_radiance(scene, points, reference_settings(c, samples, seed), progress);
}

inline double mean_of(const std::vector<ReferenceRadiance>& reference) {
  double sum = 0;
  for (const auto& r : reference) sum += average(r.radiance);
  return sum / static_cast<double>(reference.size());
}

// Agreement of a bake with the reference at points in world space: the ratio of the means, and the
// RMS difference over the reference's mean.
struct Agreement {
  double mean_ratio, relative_rms;
};

// Compares each reference with found(i), the radiance at its point.
template <class Found>
Agreement compare(std::size_t count, const std::vector<ReferenceRadiance>& reference, Found found) {
  double baked = 0, truth = 0, square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec<3, float> radiance = found(i);
    for (int k = 0; k < 3; ++k) {
      baked += radiance[k];
      truth += reference[i].radiance[k];
      square += std::pow(radiance[k] - reference[i].radiance[k], 2);
    }
  }
  const double n = 3 * static_cast<double>(count);
  return {baked / truth, std::sqrt(square / n) / (truth / n)};
}

template <int D>
Agreement agreement(const Scene<D>& scene, const std::vector<Vec<D>>& points,
                    const std::vector<ReferenceRadiance>& reference, EstimatorName estimator,
                    int samples, int photons) {
  const auto settings = fixed_settings<D>(estimator, fewer(samples), fewer(photons));
  const Baked<D> baked = test::baked(scene, settings);
  return compare(points.size(), reference,
                 [&](std::size_t i) { return lookup_world(scene, baked, points[i]); });
}

// Returns every `step`-th vertex of the isosurface, moved off the grid's edges and back onto the
// isosurface.
inline std::vector<Vec3> isosurface_points(const Field<3>& field, double isovalue,
                                           std::size_t step) {
  const IsosurfaceMesh mesh = contour(field, isovalue);
  std::vector<Vec3> points;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    Vec3 center(0.0);
    for (const int v : mesh.triangles[t]) center += Vec3(mesh.vertices[v]) / 3;
    points.push_back(project_to_isosurface(field, center, isovalue));
  }
  return points;
}

// Bakes, and compares the isosurface c of the first volume with path tracing.
inline void expect_agreement(const Scene<3>& scene, double c, EstimatorName estimator, int samples,
                             int photons, double mean_tolerance, double rms_tolerance) {
  const std::vector<Vec3> points =
      isosurface_points(field_of(scene), scene.volumes[0].isovalue(c), 17);
  const auto reference = traced(scene, points, c, fewer(1024), 3);
  const Agreement found = agreement(scene, points, reference, estimator, samples, photons);
  EXPECT_NEAR(found.mean_ratio, 1, sanitized ? 0.3 : mean_tolerance);
  EXPECT_LT(found.relative_rms, sanitized ? 10 : rms_tolerance);
}

}  // namespace leaflight::test
