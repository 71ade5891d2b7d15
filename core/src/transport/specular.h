// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// A ray that hits more mirrors and glass than this is given up.
inline constexpr int most_specular_bounces = 64;

// Unpolarised reflectance of a dielectric whose far side has the refractive index `ior` against the
// near one, for a ray at the given cosine to the normal; 1 beyond the critical angle.
double fresnel_reflectance(double cosine, double ior);

// How a ray goes on after a mirror or glass: from `from`, which is the far side of the surface if
// it was refracted. `weight` is what its flux is multiplied with.
template <int D>
struct SpecularBounce {
  SurfacePoint<D> from;
  Vec<D> direction;
  Rgb weight;
  // What radiance is multiplied with besides, since it grows with the square of the refractive
  // index (Veach 1997, ch. 5.2), in the plane with the index.
  Real radiance_scale = 1;
};

// `u` uniform in [0,1) chooses between reflection and refraction in proportion to their shares.
template <int D>
SpecularBounce<D> specular_bounce(const SurfacePoint<D>& point, const Vec<D>& direction, double u);

}  // namespace leaflight
