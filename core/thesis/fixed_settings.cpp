// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/fixed_settings.h"

#include "bake/plan/settings.h"
#include "base/error.h"

namespace leaflight {

template <int D>
void validate(const FixedSettings<D>& settings) {
  if (!(settings.samples >= 1 && settings.samples <= (1 << 20))) {
    throw Error("The number of samples per texel is " + std::to_string(settings.samples) +
                "; choose between 1 and 1048576.");
  }
  for (const std::uint64_t photons : {settings.photons, settings.caustic_photons}) {
    if (!(photons >= 1 && photons <= (std::uint64_t{1} << 32))) {
      throw Error("The number of photons is " + std::to_string(photons) +
                  "; choose between 1 and 4294967296.");
    }
  }
  validate(settings.photon_map);
  const EstimatorTraits& estimator = traits_of(settings.estimator);
  if (!settings.only_at.empty() && estimator.photons) {
    throw Error("The estimator " + estimator.name +
                " needs all texels; bake those at some points alone with the path estimator.");
  }
  validate_threads(settings.threads);
}

template void validate<2>(const FixedSettings<2>&);
template void validate<3>(const FixedSettings<3>&);

}  // namespace leaflight
