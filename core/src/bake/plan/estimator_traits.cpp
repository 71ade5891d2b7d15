// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/plan/estimator_traits.h"

#include <algorithm>
#include <array>

#include "math/error.h"

namespace leaflight {
namespace {

// In the order of their enumeration.
const std::array<EstimatorTraits, 4> estimators{{
    // estimator, name, rays, photons, caches, surroundings, density, caustics
    {EstimatorName::volumetric, "volumetric", 0, true, true, false, true, false},
    {EstimatorName::gather, "gather", 1, true, true, true, false, false},
    {EstimatorName::path, "path", 6, false, false, false, false, true},
    {EstimatorName::thesis, "thesis", 0, true, false, false, false, true},
}};

}  // namespace

const EstimatorTraits& traits_of(EstimatorName estimator) {
  return estimators[static_cast<std::size_t>(estimator)];
}

EstimatorName estimator_from(const std::string& name) {
  const auto found = std::find_if(estimators.begin(), estimators.end(),
                                  [&](const EstimatorTraits& one) { return one.name == name; });
  if (found != estimators.end()) return found->estimator;
  throw Error("There is no estimator named '" + name +
              "'; choose gather, volumetric, path or thesis.");
}

}  // namespace leaflight
