// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/plan/settings.h"

#include "math/error.h"
#include "thesis/thesis.h"

namespace leaflight {

template <int D>
void validate(const BakeSettings<D>& settings) {
  if (!(settings.samples >= 0 && settings.samples <= (1 << 20))) {
    throw Error("The number of samples per texel is " + std::to_string(settings.samples) +
                "; choose between 1 and 1048576, or 0 for rounds.");
  }
  if (!(settings.error > 0 && settings.error <= 100)) {
    throw Error("The error to reach is " + std::to_string(settings.error) +
                " percent; choose a number above 0, up to 100.");
  }
  if (!(settings.seconds >= 0)) {
    throw Error("The time limit is " + std::to_string(settings.seconds) +
                " seconds; choose 0 for none, or a number above it.");
  }
  for (const std::uint64_t photons : {settings.photons, settings.caustic_photons}) {
    if (!(photons >= 1 && photons <= (std::uint64_t{1} << 32))) {
      throw Error("The number of photons is " + std::to_string(photons) +
                  "; choose between 1 and 4294967296.");
    }
  }
  if (settings.thesis) validate(settings.thesis->photon_map);
  const EstimatorTraits& estimator = traits_of(settings.estimator);
  if (!settings.only_at.empty() && estimator.photons) {
    throw Error("The estimator " + estimator.name +
                " needs all texels; bake those at some points alone with the path estimator.");
  }
  if (!(settings.threads >= 0 && settings.threads <= 4096)) {
    throw Error("The number of threads is " + std::to_string(settings.threads) +
                "; choose 0 for all, or up to 4096.");
  }
}

template void validate<2>(const BakeSettings<2>&);
template void validate<3>(const BakeSettings<3>&);

}  // namespace leaflight
