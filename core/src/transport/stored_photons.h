// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/progress.h"
#include "transport/photon_tracer.h"

namespace leaflight {

// A photon at a hit of an isosurface. Its projection into space is in the cloud of points of thesis
// 4.3.5.
template <int D>
struct StoredPhoton {
  Vec<D, float> position;  // frame
  double c;
  Rgb flux_height;
  int volume;   // number of the volume whose isosurface it hit
  bool back;    // true if it came from the side h >= c
  bool direct;  // true if it came straight from a light
};

// Traces `count` photons and returns all that hit isosurfaces, ordered by photon number for any
// number of threads.
template <int D>
std::vector<StoredPhoton<D>> collect_photons(const SceneTracer<D>& tracer,
                                             const LightSampler<D>& lights, std::uint64_t seed,
                                             std::uint64_t count, Progress& progress);

}  // namespace leaflight
