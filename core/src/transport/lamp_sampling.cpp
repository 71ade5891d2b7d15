// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/lamp_sampling.h"

#include <cmath>
#include <limits>

namespace leaflight {
namespace {

// The measure of a disc, or in 2D a segment, of radius 1.
template <int D>
constexpr double unit_disc = D == 3 ? pi : 2.0;

double one_minus_cosine(double sine) { return sine * sine / (1 + std::sqrt(1 - sine * sine)); }

// Area lights.

template <int D>
double power(const AreaLight<D>& light, const BoundingSphere<D>&) {
  return projected_hemisphere<D> * light.area() * average(light.radiance);
}

// Returns the power of a diffuse emitter: pi A L (thesis Eq. 3.3), or 2 length L in the plane (Eq.
// 3.4).
template <int D>
double most_flux(const AreaLight<D>& light, const BoundingSphere<D>&) {
  return largest(light.radiance * static_cast<Real>(projected_hemisphere<D> * light.area()));
}

template <int D>
LightSample<D> sample(const AreaLight<D>& light, const Vec<D>& from,
                      const std::array<double, 2>& u) {
  LightSample<D> s;
  s.end = light.point(u);
  s.end_normal = light.normal();
  const Vec<D> to_light = s.end - from;
  const double distance = to_light.length();
  if (!(distance > 0)) return s;
  s.direction = to_light / distance;
  const double cosine = -s.direction.dot(s.end_normal);
  if (cosine > 0) {
    s.radiance = light.radiance * static_cast<Real>(cosine * light.area() / spread<D>(distance));
  }
  return s;
}

template <int D>
EmittedPhoton<D> emit(const AreaLight<D>& light, const BoundingSphere<D>&,
                      const std::array<double, 2>& u_position,
                      const std::array<double, 2>& u_direction) {
  const Vec<D> normal = light.normal();
  return {leave_plane<D>(light.point(u_position), normal),
          sample_cosine_hemisphere<D>(normal, u_direction),
          light.radiance * static_cast<Real>(projected_hemisphere<D> * light.area())};
}

template <int D>
LightSource<D> source(const AreaLight<D>& light, const std::array<double, 2>& u) {
  LightSource<D> s;
  s.position = light.point(u);
  s.normal = light.normal();
  s.sphere = false;
  s.amount = light.radiance * static_cast<Real>(light.area());
  return s;
}

template <int D>
Rgb along(const AreaLight<D>& light, const Vec<D>& origin, const Vec<D>& direction, double t_max) {
  const Vec<D> normal = light.normal();
  const double approach = -direction.dot(normal);
  if (!(approach > 0)) return Rgb(0);
  const double t = (origin - light.corner).dot(normal) / approach;
  // A light in the plane of a wall is in front of it.
  constexpr double slack = 64 * std::numeric_limits<float>::epsilon();
  if (!(t > 0 && (t - t_max) * approach < slack)) return Rgb(0);
  const Vec<D> at = origin + direction * t - light.corner;
  double radius2 = 0;
  for (const Vec<D>& edge : light.edges) {
    const double x = 2 * at.dot(edge) / edge.dot(edge) - 1;
    if (!(std::abs(x) <= 1)) return Rgb(0);
    radius2 += x * x;
  }
  return light.ellipse && radius2 > 1 ? Rgb(0) : light.radiance;
}

// Point and spot lights.

// Returns the share of the intensity inside a cone, for a unit direction away from the light. Its
// edge is smooth, as in Blender.
template <int D>
double cone_factor(const std::optional<typename PointLight<D>::Cone>& cone,
                   const Vec<D>& direction) {
  if (!cone) return 1;
  const double cosine = direction.dot(cone->axis);
  const double inside = cosine - cone->cosine;
  if (!(inside > 0)) return 0;
  const double edge = (1 - cone->cosine) * cone->blend;
  const double t = inside < edge ? inside / edge : 1;
  const double falloff = cone->cosine_falloff ? std::max(0.0, cosine) : 1;
  return falloff * t * t * (3 - 2 * t);
}

template <int D>
double emitted_angle(const PointLight<D>& light) {
  return light.cone ? cone_measure<D>(1 - light.cone->cosine) : all_directions<D>;
}

template <int D>
double power(const PointLight<D>& light, const BoundingSphere<D>&) {
  // An order of magnitude suffices to choose lights.
  return emitted_angle(light) * average(light.intensity);
}

template <int D>
double most_flux(const PointLight<D>& light, const BoundingSphere<D>&) {
  return emitted_angle(light) * largest(light.intensity);
}

template <int D>
LightSample<D> sample(const PointLight<D>& light, const Vec<D>& from,
                      const std::array<double, 2>& u) {
  LightSample<D> s;
  const Vec<D> to_light = light.position - from;
  const double distance = to_light.length();
  if (!(distance > light.radius)) return s;  // inside the sphere
  const Vec<D> axis = to_light / distance;
  if (light.radius == 0) {
    s.direction = axis;
    s.end = light.position;
    s.end_normal = -axis;
    s.radiance = light.intensity *
                 static_cast<Real>(cone_factor<D>(light.cone, -axis) / spread<D>(distance));
    return s;
  }
  const double sine = light.radius / distance, cap = one_minus_cosine(sine);
  s.direction = sample_cone<D>(axis, cap, u);
  // Find the near end of the ray's way through the sphere.
  const double middle = s.direction.dot(to_light);
  const double beside2 = (to_light - s.direction * middle).length2();
  const double half = std::sqrt(std::max(0.0, light.radius * light.radius - beside2));
  s.end = from + s.direction * (middle - half);
  s.end_normal = (s.end - light.position).normalized();
  const double radiance =
      cone_factor<D>(light.cone, -s.direction) / (unit_disc<D> * spread<D>(light.radius));
  s.radiance = light.intensity * static_cast<Real>(radiance * cone_measure<D>(cap));
  return s;
}

template <int D>
EmittedPhoton<D> emit(const PointLight<D>& light, const BoundingSphere<D>&,
                      const std::array<double, 2>& u_position,
                      const std::array<double, 2>& u_direction) {
  Vec<D> axis(0.0);
  axis[0] = 1;
  if (light.cone) axis = light.cone->axis;
  const Vec<D> direction =
      sample_cone<D>(axis, light.cone ? 1 - light.cone->cosine : 2, u_direction);
  // Sample a point of the sphere as seen from infinity in this direction.
  const Vec<D> beside = sample_facing_disc<D>(direction, u_position);
  const double forward = std::sqrt(std::max(0.0, 1 - beside.length2()));
  const double factor = cone_factor<D>(light.cone, direction) * emitted_angle(light);
  return {light.position + (beside + direction * forward) * light.radius, direction,
          light.intensity * static_cast<Real>(factor)};
}

template <int D>
LightSource<D> source(const PointLight<D>& light, const std::array<double, 2>& u) {
  LightSource<D> s;
  s.position = light.position;
  s.amount = light.intensity;
  s.cone = light.cone;
  if (light.radius == 0) return s;
  Vec<D> axis(0.0);
  axis[0] = 1;
  s.normal = sample_cone<D>(axis, 2, u);
  s.position += s.normal * light.radius;
  s.sphere = false;
  // A point of the sphere faces half of all directions; from infinity, the sphere is a disc.
  s.amount *= static_cast<Real>(all_directions<D> / unit_disc<D>);
  return s;
}

template <int D>
Rgb along(const PointLight<D>& light, const Vec<D>& origin, const Vec<D>& direction, double t_max) {
  if (light.radius == 0) return Rgb(0);
  const Vec<D> to_light = light.position - origin;
  const double middle = direction.dot(to_light);
  const double inside2 = light.radius * light.radius - (to_light - direction * middle).length2();
  if (!(inside2 > 0)) return Rgb(0);
  const double t = middle - std::sqrt(inside2);
  if (!(t > 0 && t < t_max)) return Rgb(0);
  return light.intensity * static_cast<Real>(cone_factor<D>(light.cone, -direction) /
                                             (unit_disc<D> * spread<D>(light.radius)));
}

// Suns.

// Returns the radiance of the disc of directions for unit irradiance on a surface that faces it.
template <int D>
double sun_radiance(const SunLight<D>& light) {
  const double sine = std::sin(0.5 * light.angle);
  return D == 3 ? 1 / (pi * sine * sine) : 1 / (2 * sine);
}

template <int D>
double power(const SunLight<D>& light, const BoundingSphere<D>& bounds) {
  return average(light.irradiance) * parallel_area(bounds);
}

template <int D>
double most_flux(const SunLight<D>& light, const BoundingSphere<D>& bounds) {
  // A photon's flux is the radiance times the area, over the constant density of its direction.
  const double cap = 1 - std::cos(0.5 * light.angle);
  const double scale = light.angle > 0 ? sun_radiance(light) * cone_measure<D>(cap) : 1;
  return largest(light.irradiance) * parallel_area(bounds) * scale;
}

template <int D>
LightSample<D> sample(const SunLight<D>& light, const Vec<D>&, const std::array<double, 2>& u) {
  LightSample<D> s;
  s.infinite = true;
  s.direction = -light.direction;
  s.radiance = light.irradiance;
  if (light.angle > 0) {
    const double cap = one_minus_cosine(std::sin(0.5 * light.angle));
    s.direction = sample_cone<D>(-light.direction, cap, u);
    s.radiance *= static_cast<Real>(sun_radiance(light) * cone_measure<D>(cap));
  }
  return s;
}

template <int D>
EmittedPhoton<D> emit(const SunLight<D>& light, const BoundingSphere<D>& bounds,
                      const std::array<double, 2>& u_position,
                      const std::array<double, 2>& u_direction) {
  const LightSample<D> s = sample(light, Vec<D>(0.0), u_direction);
  return {parallel_origin<D>(bounds, -s.direction, u_position), -s.direction,
          s.radiance * static_cast<Real>(parallel_area(bounds))};
}

template <int D>
LightSource<D> source(const SunLight<D>& light, const std::array<double, 2>& u) {
  const LightSample<D> sampled = sample(light, Vec<D>(0.0), u);
  LightSource<D> s;
  s.infinite = true;
  s.direction = -sampled.direction;
  s.amount = sampled.radiance;
  return s;
}

template <int D>
Rgb along(const SunLight<D>& light, const Vec<D>&, const Vec<D>& direction, double t_max) {
  if (t_max < std::numeric_limits<double>::infinity() || light.angle == 0) return Rgb(0);
  if (!(-direction.dot(light.direction) >= std::cos(0.5 * light.angle))) return Rgb(0);
  return light.irradiance * static_cast<Real>(sun_radiance(light));
}

}  // namespace

template <int D>
double power_of(const Light<D>& light, const BoundingSphere<D>& bounds) {
  return std::visit([&](const auto& l) { return power(l, bounds); }, light);
}

template <int D>
double largest_flux_of(const Light<D>& light, const BoundingSphere<D>& bounds) {
  return std::visit([&](const auto& l) { return most_flux(l, bounds); }, light);
}

template <int D>
LightSample<D> sample_light(const Light<D>& light, const Vec<D>& from,
                            const std::array<double, 2>& u) {
  return std::visit([&](const auto& l) { return sample(l, from, u); }, light);
}

template <int D>
EmittedPhoton<D> emit_from(const Light<D>& light, const BoundingSphere<D>& bounds,
                           const std::array<double, 2>& u_position,
                           const std::array<double, 2>& u_direction) {
  return std::visit([&](const auto& l) { return emit(l, bounds, u_position, u_direction); }, light);
}

template <int D>
double LightSource<D>::strength(const Vec<D>& outgoing, double distance) const {
  if (infinite) return 1;
  double factor = 1 / spread<D>(distance);
  if (!sphere) {
    const double cosine = outgoing.dot(normal);
    factor *= both_sides ? std::abs(cosine) : std::max(0.0, cosine);
  }
  return factor * cone_share(outgoing);
}

template <int D>
double LightSource<D>::cone_share(const Vec<D>& outgoing) const {
  return cone_factor<D>(cone, outgoing);
}

template <int D>
LightSource<D> source_of(const Light<D>& light, const std::array<double, 2>& u) {
  return std::visit([&](const auto& l) { return source(l, u); }, light);
}

template <int D>
Rgb radiance_along(const Light<D>& light, const Vec<D>& origin, const Vec<D>& direction,
                   double t_max) {
  return std::visit([&](const auto& l) { return along(l, origin, direction, t_max); }, light);
}

template <int D>
Vec<D> parallel_origin(const BoundingSphere<D>& bounds, const Vec<D>& direction,
                       const std::array<double, 2>& u) {
  return bounds.center + (sample_facing_disc<D>(direction, u) - direction) * bounds.radius;
}

template <int D>
double parallel_area(const BoundingSphere<D>& bounds) {
  return unit_disc<D> * spread<D>(bounds.radius);
}

template double power_of<2>(const Light<2>&, const BoundingSphere<2>&);
template double power_of<3>(const Light<3>&, const BoundingSphere<3>&);
template double largest_flux_of<2>(const Light<2>&, const BoundingSphere<2>&);
template double largest_flux_of<3>(const Light<3>&, const BoundingSphere<3>&);
template LightSample<2> sample_light<2>(const Light<2>&, const Vec<2>&,
                                        const std::array<double, 2>&);
template LightSample<3> sample_light<3>(const Light<3>&, const Vec<3>&,
                                        const std::array<double, 2>&);
template EmittedPhoton<2> emit_from<2>(const Light<2>&, const BoundingSphere<2>&,
                                       const std::array<double, 2>&, const std::array<double, 2>&);
template EmittedPhoton<3> emit_from<3>(const Light<3>&, const BoundingSphere<3>&,
                                       const std::array<double, 2>&, const std::array<double, 2>&);
template struct LightSource<2>;
template struct LightSource<3>;
template LightSource<2> source_of<2>(const Light<2>&, const std::array<double, 2>&);
template LightSource<3> source_of<3>(const Light<3>&, const std::array<double, 2>&);
template Rgb radiance_along<2>(const Light<2>&, const Vec<2>&, const Vec<2>&, double);
template Rgb radiance_along<3>(const Light<3>&, const Vec<3>&, const Vec<3>&, double);
template Vec<2> parallel_origin<2>(const BoundingSphere<2>&, const Vec<2>&,
                                   const std::array<double, 2>&);
template Vec<3> parallel_origin<3>(const BoundingSphere<3>&, const Vec<3>&,
                                   const std::array<double, 2>&);
template double parallel_area<2>(const BoundingSphere<2>&);
template double parallel_area<3>(const BoundingSphere<3>&);

}  // namespace leaflight
