// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/math/progress.h"
#include "leaflight/scene/scene.h"

namespace leaflight {

struct ReferenceRadiance {
  Rgb radiance;
  Rgb standard_error;
};

// Unbiased radiance of the outer side of the leaf at given points (world), by `samples` paths each.
// Points outside the domain, in masked cells or where |grad h| = 0 give zero.
template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<Vec<D>>& points,
                                                  double isovalue, int samples, std::uint64_t seed,
                                                  Progress& progress);

}  // namespace leaflight
