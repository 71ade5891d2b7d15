// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/plan/plan.h"

namespace leaflight {

enum class EstimatorName { volumetric, gather, path, thesis };

// Properties of an estimator of indirect light that a bake needs before it has any light.
struct EstimatorTraits : IndirectMethod {
  EstimatorName estimator;
  double rays_per_sample;  // on average
  bool caches;             // true if photons go to the caches of isosurfaces
};

const EstimatorTraits& traits_of(EstimatorName estimator);

// Returns the estimator "volumetric", "gather", "path" or "thesis"; throws Error for other names.
EstimatorName estimator_from(const std::string& name);

}  // namespace leaflight
