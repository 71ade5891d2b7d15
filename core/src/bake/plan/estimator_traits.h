// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace leaflight {

enum class EstimatorName { volumetric, gather, path, thesis };

// What a bake must know of an estimator of soft light before there is any light.
struct EstimatorTraits {
  EstimatorName estimator;
  std::string name;
  double rays_per_sample;  // on average
  bool photons;            // they must be traced, and serve all texels
  bool caches;             // they fall into the caches of leaves and surroundings
  bool surroundings;       // their radiance is looked up
  bool density;            // photons' density is looked up with all its noise
  bool caustics;           // are part of its light
};

const EstimatorTraits& traits_of(EstimatorName estimator);

// "volumetric", "gather", "path" or "thesis"; throws Error for any other name.
EstimatorName estimator_from(const std::string& name);

}  // namespace leaflight
