// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// A ray ends after this number of mirrors and glass surfaces.
inline constexpr int most_specular_bounces = 64;
// A path ends after this number of diffuse surfaces. It would not end in a closed white room.
inline constexpr int most_diffuse_bounces = 1024;

// Returns the unpolarized reflectance of a dielectric at the given cosine to the normal; 1 beyond
// the critical angle. `ior`: index of the far side relative to the near one.
double fresnel_reflectance(double cosine, double ior);

// The continuation of a ray after a mirror or glass. `from`: its origin, on the far side of the
// surface after refraction. `weight`: factor on its flux.
template <int D>
struct SpecularBounce {
  SurfacePoint<D> from;
  Vec<D> direction;
  Rgb weight;
  // An additional factor on radiance, which grows with the square of the refractive index (Veach
  // 1997, ch. 5.2); in 2D with the index.
  Real radiance_scale = 1;
};

// Chooses between reflection and refraction in proportion to their shares. `u`: uniform in [0,1).
template <int D>
SpecularBounce<D> specular_bounce(const SurfacePoint<D>& point, const Vec<D>& direction, double u);

}  // namespace leaflight
