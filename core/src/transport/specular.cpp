// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/specular.h"

#include <cmath>

#include "base/sampling.h"

namespace leaflight {
namespace {

// Returns v_in - 2 (N.v_in) N (thesis 3.3.6, corrected).
template <int D>
Vec<D> mirrored(const Vec<D>& direction, const Vec<D>& normal) {
  return direction - normal * (2 * normal.dot(direction));
}

// Reflects about the shading normal, unless the ray would then enter the traced surface.
template <int D>
Vec<D> reflected(const SurfacePoint<D>& point, const Vec<D>& direction) {
  const Vec<D> smooth = mirrored<D>(direction, point.shading_normal);
  return smooth.dot(point.geometric_normal) > 0 ? smooth
                                                : mirrored<D>(direction, point.geometric_normal);
}

template <int D>
Vec<D> refracted(const Vec<D>& direction, const Vec<D>& normal, double ior) {
  const double cosine = -direction.dot(normal);
  const double far_cosine = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (ior * ior)));
  return (direction / ior + normal * (cosine / ior - far_cosine)).normalized();
}

}  // namespace

double fresnel_reflectance(double cosine, double ior) {
  const double far_sine2 = (1 - cosine * cosine) / (ior * ior);
  if (far_sine2 >= 1) return 1;
  const double far_cosine = std::sqrt(1 - far_sine2);
  const double parallel = (ior * cosine - far_cosine) / (ior * cosine + far_cosine);
  const double perpendicular = (cosine - ior * far_cosine) / (cosine + ior * far_cosine);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

template <int D>
SpecularBounce<D> specular_bounce(const SurfacePoint<D>& point, const Vec<D>& incoming, double u) {
  const Vec<D> direction = incoming.normalized();
  SpecularBounce<D> bounce{point, Vec<D>(0.0), point.albedo};
  if (point.scattering == Scattering::mirror) {
    bounce.direction = reflected(point, direction);
    return bounce;
  }
  const bool smooth = direction.dot(point.shading_normal) < 0;
  const Vec<D>& normal = smooth ? point.shading_normal : point.geometric_normal;
  const double cosine = std::min(1.0, std::max(0.0, -direction.dot(normal)));
  if (u < fresnel_reflectance(cosine, point.ior)) {
    bounce.direction = reflected(point, direction);
    return bounce;
  }
  bounce.direction = refracted<D>(direction, normal, point.ior);
  if (!(bounce.direction.dot(point.geometric_normal) < 0)) {
    bounce.direction = refracted<D>(direction, point.geometric_normal, point.ior);
  }
  bounce.radiance_scale = static_cast<Real>(1 / spread<D>(point.ior));
  bounce.from.geometric_normal = -point.geometric_normal;
  bounce.from.shading_normal = -point.shading_normal;
  if (auto* isosurface = std::get_if<IsosurfacePlace<D>>(&bounce.from.on))
    isosurface->back = !isosurface->back;
  bounce.from.ior = 1 / point.ior;
  return bounce;
}

template SpecularBounce<2> specular_bounce<2>(const SurfacePoint<2>&, const Vec<2>&, double);
template SpecularBounce<3> specular_bounce<3>(const SurfacePoint<3>&, const Vec<3>&, double);

}  // namespace leaflight
