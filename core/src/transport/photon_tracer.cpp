// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/photon_tracer.h"

#include <cmath>

#include "leaflight/math/sampling.h"

namespace leaflight {

double shading_normal_factor(const SurfacePoint& point, const Vec3& direction) {
  if (point.kind != HitKind::leaf) return 1;
  const double shading = -direction.dot(point.shading_normal);
  const double geometric = -direction.dot(point.geometric_normal);
  return shading > 0 && geometric > 0 ? shading / geometric : 0;
}

Reflection reflect_photon(const PhotonHit& arrival, Real reference_flux, Random& random) {
  const SurfacePoint& point = arrival.point;
  Rgb flux = arrival.flux_height * point.albedo;
  // Russian roulette keeps the photons' fluxes alike (thesis 1.3, Jensen 2001).
  const Real survival = std::min(Real(1), largest(flux) / reference_flux);
  if (!(random.uniform() < survival)) return {false, Vec3(0.0), Rgb(0)};
  flux /= survival;
  return {true,
          sample_cosine_hemisphere(point.geometric_normal, {random.uniform(), random.uniform()}),
          flux};
}

}  // namespace leaflight
