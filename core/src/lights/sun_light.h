// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/bounding_sphere.h"
#include "lights/light_sample.h"

namespace leaflight {

// Parallel light, or light from a disc of directions with the given angular diameter.
template <int D>
struct SunLight {
  std::string name;
  Vec<D> direction;  // unit, away from the sun
  Rgb irradiance;    // [W/m^2] on a surface that faces it
  double angle = 0;  // diameter in radians, below pi

  // light.h describes these functions.
  void check() const;
  std::vector<Vec<D>> corners() const { return {}; }
  void to_frame(const Vec<D>&, double) {}
  Rgb amount() const { return irradiance; }
  std::optional<Vec<D>> place() const { return std::nullopt; }
  double power(const BoundingSphere<D>& bounds) const;
  double largest_flux(const BoundingSphere<D>& bounds) const;
  double near_irradiance() const { return average(irradiance); }
  LightSample<D> sample(const Vec<D>& from, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(const BoundingSphere<D>& bounds, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  LightSource<D> source(const std::array<double, 2>& u) const;
  Rgb radiance_along(const Vec<D>& origin, const Vec<D>& to, double t_max) const;
  double width() const { return angle; }
  double aspect() const { return 1; }
  LightSource<D> light_point(const std::array<double, 2>& u) const { return source(u); }

 private:
  double unit_radiance() const;
};

}  // namespace leaflight
