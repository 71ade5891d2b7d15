// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/photon_tracer.h"

#include <cmath>

namespace leaflight {

template <int D>
double shading_normal_factor(const SurfacePoint<D>& point, const Vec<D>& direction) {
  if (point.kind() != HitKind::isosurface) return 1;
  const double shading = -direction.dot(point.shading_normal);
  const double geometric = -direction.dot(point.geometric_normal);
  return shading > 0 && geometric > 0 ? shading / geometric : 0;
}

Rgb survivor(const Rgb& flux_height, Real reference_flux, Random& random) {
  const Real survival = std::min(Real(1), largest(flux_height) / reference_flux);
  return random.uniform() < survival ? flux_height / survival : Rgb(0);
}

template double shading_normal_factor<2>(const SurfacePoint<2>&, const Vec<2>&);
template double shading_normal_factor<3>(const SurfacePoint<3>&, const Vec<3>&);

}  // namespace leaflight
