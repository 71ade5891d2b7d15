// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "leaflight/bake/bake.h"
#include "leaflight/transport/reference.h"
#include "scenes.h"

namespace leaflight::test {

inline double mean_of(const std::vector<ReferenceRadiance>& reference) {
  double sum = 0;
  for (const auto& r : reference) sum += average(r.radiance);
  return sum / static_cast<double>(reference.size());
}

// Of a bake, looked up at points (world), with the reference there: the ratio of the means, and the
// RMS difference over the reference's mean.
struct Agreement {
  double mean_ratio, relative_rms;
};

template <int D>
Agreement agreement(const Scene<D>& scene, const std::vector<Vec<D>>& points,
                    const std::vector<ReferenceRadiance>& reference, EstimatorName estimator,
                    int samples, std::uint64_t photons) {
  BakeSettings<D> settings;
  settings.samples = samples;
  settings.photons = photons;
  settings.estimator = estimator;
  Progress progress;
  const Baked<D> baked_scene = bake(scene, settings, progress);
  double baked = 0, truth = 0, square = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto radiance = lookup_world(scene, baked_scene, points[i]);
    for (int k = 0; k < 3; ++k) {
      baked += radiance[k];
      truth += reference[i].radiance[k];
      square += std::pow(radiance[k] - reference[i].radiance[k], 2);
    }
  }
  const double n = 3 * static_cast<double>(points.size());
  return {baked / truth, std::sqrt(square / n) / (truth / n)};
}

}  // namespace leaflight::test
