// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/sun_light.h"

#include <limits>

#include "lights/light_checks.h"

namespace leaflight {

template <int D>
void SunLight<D>::check() const {
  const std::string light = "The light '" + name + "'";
  if (!(std::abs(direction.length() - 1) < 1e-6)) {
    throw Error(light + " has a direction that is not of length 1; normalize it.");
  }
  if (!(angle >= 0 && angle < pi)) {
    throw Error(light + " has an angle that is not between 0 and 180 degrees; correct it.");
  }
  check_light_amount(irradiance, light, "irradiance");
}

// Returns the radiance of the disc of directions for unit irradiance on a surface that faces it.
template <int D>
double SunLight<D>::unit_radiance() const {
  const double sine = std::sin(0.5 * angle);
  return D == 3 ? 1 / (pi * sine * sine) : 1 / (2 * sine);
}

template <int D>
double SunLight<D>::power(const BoundingSphere<D>& bounds) const {
  return average(irradiance) * bounds.parallel_area();
}

template <int D>
double SunLight<D>::largest_flux(const BoundingSphere<D>& bounds) const {
  // A photon's flux is the radiance times the area, over the constant density of its direction.
  const double cap = one_minus_cosine(std::sin(0.5 * angle));
  const double scale = angle > 0 ? unit_radiance() * cone_measure<D>(cap) : 1;
  return largest(irradiance) * bounds.parallel_area() * scale;
}

template <int D>
LightSample<D> SunLight<D>::sample(const Vec<D>&, const std::array<double, 2>& u) const {
  LightSample<D> s;
  s.infinite = true;
  s.direction = -direction;
  s.radiance = irradiance;
  if (angle > 0) {
    const double cap = one_minus_cosine(std::sin(0.5 * angle));
    s.direction = sample_cone<D>(-direction, cap, u);
    s.radiance *= static_cast<Real>(unit_radiance() * cone_measure<D>(cap));
  }
  return s;
}

template <int D>
EmittedPhoton<D> SunLight<D>::emit(const BoundingSphere<D>& bounds,
                                   const std::array<double, 2>& u_position,
                                   const std::array<double, 2>& u_direction) const {
  const LightSample<D> s = sample(Vec<D>(0.0), u_direction);
  return {bounds.parallel_origin(-s.direction, u_position), -s.direction,
          s.radiance * static_cast<Real>(bounds.parallel_area())};
}

template <int D>
LightSource<D> SunLight<D>::source(const std::array<double, 2>& u) const {
  const LightSample<D> sampled = sample(Vec<D>(0.0), u);
  LightSource<D> s;
  s.infinite = true;
  s.direction = -sampled.direction;
  s.amount = sampled.radiance;
  return s;
}

template <int D>
Rgb SunLight<D>::radiance_along(const Vec<D>&, const Vec<D>& to, double t_max) const {
  if (t_max < std::numeric_limits<double>::infinity() || angle == 0) return Rgb(0);
  if (!(-to.dot(direction) >= std::cos(0.5 * angle))) return Rgb(0);
  return irradiance * static_cast<Real>(unit_radiance());
}

template struct SunLight<2>;
template struct SunLight<3>;

}  // namespace leaflight
