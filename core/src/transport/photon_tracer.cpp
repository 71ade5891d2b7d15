// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/photon_tracer.h"

#include <cmath>

#include "leaflight/math/sampling.h"

namespace leaflight {

template <int D>
double shading_normal_factor(const SurfacePoint<D>& point, const Vec<D>& direction) {
  if (point.kind != HitKind::leaf) return 1;
  const double shading = -direction.dot(point.shading_normal);
  const double geometric = -direction.dot(point.geometric_normal);
  return shading > 0 && geometric > 0 ? shading / geometric : 0;
}

template <int D>
Reflection<D> reflect_photon(const PhotonHit<D>& arrival, Real reference_flux, Random& random) {
  const SurfacePoint<D>& point = arrival.point;
  Rgb flux = arrival.flux_height * point.albedo;
  // Russian roulette keeps the photons' fluxes alike (thesis 1.3, Jensen 2001).
  const Real survival = std::min(Real(1), largest(flux) / reference_flux);
  if (!(random.uniform() < survival)) return {false, Vec<D>(0.0), Rgb(0)};
  flux /= survival;
  return {true,
          sample_cosine_hemisphere<D>(point.geometric_normal, {random.uniform(), random.uniform()}),
          flux};
}

template double shading_normal_factor<2>(const SurfacePoint<2>&, const Vec<2>&);
template double shading_normal_factor<3>(const SurfacePoint<3>&, const Vec<3>&);
template Reflection<2> reflect_photon<2>(const PhotonHit<2>&, Real, Random&);
template Reflection<3> reflect_photon<3>(const PhotonHit<3>&, Real, Random&);

}  // namespace leaflight
