// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/estimator_traits.h"

#include <algorithm>
#include <array>

#include "base/error.h"

namespace leaflight {
namespace {

// The order is that of EstimatorName.
const std::array<EstimatorTraits, 4> estimators{{
    // {name, photons, walls, caustics}, estimator, rays, caches
    {{"volumetric", true, false, false}, EstimatorName::volumetric, 0, true},
    {{"gather", true, true, false}, EstimatorName::gather, 1, true},
    {{"path", false, false, true}, EstimatorName::path, 6, false},
    {{"thesis", true, false, true}, EstimatorName::thesis, 0, false},
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
