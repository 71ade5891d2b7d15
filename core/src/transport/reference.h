// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/progress.h"
#include "scene/scene.h"

namespace leaflight {

struct ReferenceRadiance {
  Rgb radiance;
  Rgb standard_error;
};

struct ReferenceSettings {
  double c = 0;  // common isovalue
  int samples = 1024;
  std::uint64_t seed = 0;
  int volume = 0;     // number of the volume of the isosurface
  bool back = false;  // true for the back of the isosurface
};

// Computes the radiance of the isosurface at points in world coordinates, with `samples` paths
// each. It is unbiased, except for caustics of lights without extent, which no path hits. Points
// outside the domain, in masked cells or where |grad h| = 0 give zero.
template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<Vec<D>>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress);

// A point on a wall in barycentric coordinates, seen from the front or back of the facet.
struct FacetPoint {
  int mesh = 0, facet = 0;
  double u = 0, v = 0;
  bool front = true;
};

// Computes the radiance at points on walls; ignores `settings.volume` and `settings.back`.
template <int D>
std::vector<ReferenceRadiance> reference_radiance(const Scene<D>& scene,
                                                  const std::vector<FacetPoint>& points,
                                                  const ReferenceSettings& settings,
                                                  Progress& progress);

}  // namespace leaflight
