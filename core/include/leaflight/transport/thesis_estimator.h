// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/transport/indirect_estimator.h"
#include "leaflight/transport/photon_map.h"

namespace leaflight {

// The thesis's radiance estimate (Eq. 4.8): BRDF times the photon map's irradiance, no rays at all.
// The map must outlive it.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_thesis_estimator(const PhotonMap<D>& photons);

}  // namespace leaflight
