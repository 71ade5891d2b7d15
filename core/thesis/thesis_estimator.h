// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thesis/photon_estimator.h"
#include "thesis/photon_map.h"

namespace leaflight {

// Makes one photon map per volume.
template <int D>
std::vector<PhotonMap<D>> make_photon_maps(const SceneTracer<D>& tracer,
                                           const std::vector<StoredPhoton<D>>& photons,
                                           const PhotonMapSettings& settings);

// Makes the thesis's radiance estimate (Eq. 4.8): BRDF times the photon map's irradiance, without
// rays. Its photons include caustics. The thesis stores no photons on walls. Points on walls use
// the surface cache, which must outlive the estimator and is null if there are no walls. `photons`:
// maps, one per volume.
template <int D>
std::unique_ptr<PhotonEstimator<D>> make_thesis_estimator(std::vector<PhotonMap<D>> photons,
                                                          const SurfaceCache<D>* walls);

}  // namespace leaflight
