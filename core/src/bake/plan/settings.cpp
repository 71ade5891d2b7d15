// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/plan/settings.h"

#include "base/error.h"

namespace leaflight {

template <int D>
void validate(const BakeSettings<D>& settings) {
  if (!(settings.error > 0 && settings.error <= 100)) {
    throw Error("The error to reach is " + std::to_string(settings.error) +
                " percent; choose a number above 0, up to 100.");
  }
  if (!(settings.seconds >= 0)) {
    throw Error("The time limit is " + std::to_string(settings.seconds) +
                " seconds; choose 0 for none, or a number above it.");
  }
  validate_threads(settings.threads);
}

void validate_threads(int threads) {
  if (!(threads >= 0 && threads <= 4096)) {
    throw Error("The number of threads is " + std::to_string(threads) +
                "; choose 0 for all, or up to 4096.");
  }
}

template void validate<2>(const BakeSettings<2>&);
template void validate<3>(const BakeSettings<3>&);

}  // namespace leaflight
