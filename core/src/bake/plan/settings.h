// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bake/plan/estimator_traits.h"
#include "math/vector.h"

namespace leaflight {

struct ThesisSettings;

template <int D>
struct BakeSettings {
  Index<D> resolution{};  // texels; all zero: one per voxel
  // Samples per texel or scattered sample, each one shadow ray and one gather ray; 0: rounds of
  // lines through the volume (rounds.h) until `error` or `seconds` ends them.
  int samples = 32;
  double error = 1.5;  // of rounds: the RMS error of colours to reach, in percent
  double seconds = 0;  // of rounds: no more begin after so many; 0: no limit
  std::uint64_t photons = 2'000'000;
  std::uint64_t caustic_photons = 2'000'000;
  EstimatorName estimator = EstimatorName::gather;
  std::uint64_t seed = 0;
  int threads = 0;      // 0: all
  double exposure = 1;  // radiance times this is a displayed colour, whose differences count there
  bool both_sides = false;    // the inner side's radiance too, where light can reach it
  bool surroundings = false;  // the radiance of the surroundings too, per leaf coordinate
  // Of the thesis's ways, which rounds know nothing of (thesis/thesis.h). Null: its defaults.
  std::shared_ptr<const ThesisSettings> thesis;
  // World positions: only the texels that lookups there use. Empty: all. Of the path estimator, as
  // the others look up what other texels hold.
  std::vector<Vec<D>> only_at;
};

// Throws Error for counts that make no sense.
template <int D>
void validate(const BakeSettings<D>& settings);

}  // namespace leaflight
