// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thesis/photon_map.h"
#include "transport/indirect_estimator.h"

namespace leaflight {

// The photons of each volume in a map of its own.
template <int D>
std::vector<PhotonMap<D>> make_photon_maps(const SceneTracer<D>& tracer,
                                           const std::vector<StoredPhoton<D>>& photons,
                                           const PhotonMapSettings& settings);

// The thesis's radiance estimate (Eq. 4.8): BRDF times the photon map's irradiance, no rays at all.
// Caustics are among its photons. The thesis keeps no photons of the walls; points on them
// take their light from the surface cache, which must outlive it and may be null if there are none.
// `photons`: the maps, one per volume.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_thesis_estimator(std::vector<PhotonMap<D>> photons,
                                                            const SurfaceCache<D>* walls);

}  // namespace leaflight
