// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "thesis/estimator_traits.h"
#include "thesis/photon_map.h"
#include "thesis/sample_strategy.h"
#include "thesis/scattered.h"

namespace leaflight {

// Samples scattered over the domain and interpolated into texels (thesis 3.4 and 4.4), as an
// alternative to samples in each texel.
struct ScatteredBake {
  SampleSettings samples;  // the seed is the bake's
  ScatteredSettings filter;
};

// Settings of a bake with a fixed number of samples.
template <int D>
struct FixedSettings {
  Index<D> resolution{};  // texels; zeros: one per voxel
  // Per texel or scattered sample, each with one shadow ray and one gather ray.
  int samples = 32;
  std::uint64_t photons = 2'000'000, caustic_photons = 2'000'000;
  EstimatorName estimator = EstimatorName::gather;
  PhotonMapSettings photon_map;            // for the thesis's estimator
  std::optional<ScatteredBake> scattered;  // nothing: samples in each texel
  // World positions. If there are any, only texels that lookups there use are baked. They require
  // the path estimator, because the others look up other texels.
  std::vector<Vec<D>> only_at;
  std::uint64_t seed = 0;
  int threads = 0;          // 0: all
  bool both_sides = false;  // bakes the back's radiance too, where light can reach it
  bool walls = false;       // bakes the radiance of the walls too, per common isovalue
};

// Throws Error for invalid counts.
template <int D>
void validate(const FixedSettings<D>& settings);

}  // namespace leaflight
