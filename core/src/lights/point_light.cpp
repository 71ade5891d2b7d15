// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/point_light.h"

#include "base/bounds.h"
#include "base/box.h"
#include "lights/light_checks.h"

namespace leaflight {

template <int D>
void PointLight<D>::check() const {
  const std::string light = "The light '" + name + "'";
  check_is_bounded(within_bounds(position) && radius <= farthest, light);
  if (radius < 0) throw Error(light + " has a negative radius; choose one that is 0 or more.");
  check_light_amount(intensity, light, "intensity");
  if (!cone) return;
  if (!(std::abs(cone->axis.length() - 1) < 1e-6)) {
    throw Error(light + " has an axis that is not of length 1; normalize it.");
  }
  if (!(cone->cosine > -1 && cone->cosine < 1)) {
    throw Error(light + " has a cone of no angle; choose one above 0 and below 360 degrees.");
  }
  if (!(cone->blend >= 0 && cone->blend <= 1)) {
    throw Error(light + " has a cone whose blend is not between 0 and 1; choose one that is.");
  }
}

template <int D>
std::vector<Vec<D>> PointLight<D>::corners() const {
  return Box<D>{position - Vec<D>(radius), position + Vec<D>(radius)}.corners();
}

// Intensity is radiance times area.
template <int D>
void PointLight<D>::to_frame(const Vec<D>& center, double scale) {
  position = (position - center) * scale;
  radius *= scale;
  intensity *= static_cast<Real>(spread<D>(scale));
}

template <int D>
double PointLight<D>::emitted_angle() const {
  return cone ? cone_measure<D>(1 - cone->cosine) : all_directions<D>;
}

template <int D>
double PointLight<D>::power(const BoundingSphere<D>&) const {
  // An order of magnitude suffices to choose lights.
  return emitted_angle() * average(intensity);
}

template <int D>
double PointLight<D>::largest_flux(const BoundingSphere<D>&) const {
  return emitted_angle() * largest(intensity);
}

template <int D>
double PointLight<D>::near_irradiance() const {
  return average(intensity) / std::max(spread<D>(position.length()), 1e-2);
}

template <int D>
LightSample<D> PointLight<D>::sample(const Vec<D>& from, const std::array<double, 2>& u) const {
  LightSample<D> s;
  const Vec<D> to_light = position - from;
  const double distance = to_light.length();
  if (!(distance > radius)) return s;  // inside the sphere
  const Vec<D> axis = to_light / distance;
  if (radius == 0) {
    s.direction = axis;
    s.end = position;
    s.end_normal = -axis;
    s.radiance = intensity * static_cast<Real>(share(-axis) / spread<D>(distance));
    return s;
  }
  const double cap = one_minus_cosine(radius / distance);
  s.direction = sample_cone<D>(axis, cap, u);
  // Find the near end of the ray's way through the sphere.
  const double middle = s.direction.dot(to_light);
  const double beside2 = (to_light - s.direction * middle).length2();
  const double half = std::sqrt(std::max(0.0, radius * radius - beside2));
  s.end = from + s.direction * (middle - half);
  s.end_normal = (s.end - position).normalized();
  const double radiance = share(-s.direction) / (unit_disc<D> * spread<D>(radius));
  s.radiance = intensity * static_cast<Real>(radiance * cone_measure<D>(cap));
  return s;
}

template <int D>
EmittedPhoton<D> PointLight<D>::emit(const BoundingSphere<D>&,
                                     const std::array<double, 2>& u_position,
                                     const std::array<double, 2>& u_direction) const {
  Vec<D> axis(0.0);
  axis[0] = 1;
  if (cone) axis = cone->axis;
  const Vec<D> direction = sample_cone<D>(axis, cone ? 1 - cone->cosine : 2, u_direction);
  // Sample a point of the sphere as seen from infinity in this direction.
  const Vec<D> beside = sample_facing_disc<D>(direction, u_position);
  const double forward = std::sqrt(std::max(0.0, 1 - beside.length2()));
  return {position + (beside + direction * forward) * radius, direction,
          intensity * static_cast<Real>(share(direction) * emitted_angle())};
}

template <int D>
LightSource<D> PointLight<D>::source(const std::array<double, 2>& u) const {
  LightSource<D> s;
  s.position = position;
  s.amount = intensity;
  s.cone = cone;
  if (radius == 0) return s;
  Vec<D> axis(0.0);
  axis[0] = 1;
  s.normal = sample_cone<D>(axis, 2, u);
  s.position += s.normal * radius;
  s.sphere = false;
  // A point of the sphere faces half of all directions; from infinity, the sphere is a disc.
  s.amount *= static_cast<Real>(all_directions<D> / unit_disc<D>);
  return s;
}

template <int D>
Rgb PointLight<D>::radiance_along(const Vec<D>& origin, const Vec<D>& direction,
                                  double t_max) const {
  if (radius == 0) return Rgb(0);
  const Vec<D> to_light = position - origin;
  const double middle = direction.dot(to_light);
  const double inside2 = radius * radius - (to_light - direction * middle).length2();
  if (!(inside2 > 0)) return Rgb(0);
  const double t = middle - std::sqrt(inside2);
  if (!(t > 0 && t < t_max)) return Rgb(0);
  return intensity * static_cast<Real>(share(-direction) / (unit_disc<D> * spread<D>(radius)));
}

template <int D>
double PointLight<D>::width() const {
  return 2 * radius / std::max(position.length(), 1e-6);
}

// Points of the sphere are on its disc as seen from the center of the volumes; half of its surface
// would face away.
template <int D>
LightSource<D> PointLight<D>::light_point(const std::array<double, 2>& u) const {
  if (!(position.length() > radius)) return source(u);
  LightSource<D> s;
  s.position = position;
  s.position += sample_facing_disc<D>(position.normalized(), u) * radius;
  s.amount = intensity;
  s.cone = cone;
  return s;
}

template struct PointLight<2>;
template struct PointLight<3>;

}  // namespace leaflight
