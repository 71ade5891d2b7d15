// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "leaflight/math/vector.h"

namespace leaflight {

enum class EstimatorName { volumetric, gather, path };

// "volumetric", "gather" or "path"; throws Error for any other name.
EstimatorName estimator_from(const std::string& name);

template <int D>
struct BakeSettings {
  Index<D> resolution{};  // texels; all zero: one per voxel
  int samples = 32;       // per texel, each one shadow ray and one gather ray
  std::uint64_t photons = 2'000'000;
  std::uint64_t caustic_photons = 2'000'000;
  EstimatorName estimator = EstimatorName::gather;
  std::uint64_t seed = 0;
  int threads = 0;            // 0: all
  bool both_sides = false;    // the inner side's radiance too, where light can reach it
  bool surroundings = false;  // the radiance of the surroundings too, per leaf coordinate
};

// Throws Error for counts that make no sense.
template <int D>
void validate(const BakeSettings<D>& settings);

}  // namespace leaflight
