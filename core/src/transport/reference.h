// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/progress.h"
#include "scene/scene.h"

namespace leaflight {

struct ReferenceRadiance {
  Rgb radiance;
  Rgb standard_error;
};

struct ReferenceSettings {
  double c = 0;  // the common isovalue
  int samples = 1024;
  std::uint64_t seed = 0;
  int volume = 0;     // whose isosurface it is
  bool back = false;  // on its back
};

// Radiance of the isosurface at given points (world), by `samples` paths each: unbiased, save for
// the caustics of lights without extent, which no path hits. Points outside the domain, in masked
// cells or where |grad h| = 0 give zero.
template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<Vec<D>>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress);

// A point of the walls in barycentric coordinates, seen from the side of the facet's normal
// or from behind.
struct FacetPoint {
  int mesh = 0, facet = 0;
  double u = 0, v = 0;
  bool front = true;
};

// The same at points of the walls; `settings.volume` and `.back` are not used.
template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<FacetPoint>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress);

}  // namespace leaflight
