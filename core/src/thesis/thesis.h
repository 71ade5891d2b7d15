// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "thesis/photon_map.h"
#include "thesis/sample_strategy.h"
#include "thesis/scattered.h"
#include "thesis/thesis_estimator.h"

namespace leaflight {

// The door of this folder: what a bake with fixed samples takes from the thesis, so that the report
// can compare. Rounds do not pass it.

// Samples strewn over the domain and interpolated into texels (thesis 3.4 and 4.4), instead of
// samples in each texel.
struct ScatteredBake {
  SampleSettings samples;  // their seed is the bake's
  ScatteredSettings filter;
};

struct ThesisSettings {
  PhotonMapSettings photon_map;            // of the thesis's estimator
  std::optional<ScatteredBake> scattered;  // nothing: samples in each texel
};

}  // namespace leaflight
