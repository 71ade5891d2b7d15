// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/bounding_sphere.h"
#include "lights/light_sample.h"

namespace leaflight {

// A sphere (a circle in 2D) that emits equally in all directions, or into a cone: Blender's point
// and spot lamps. It neither blocks nor reflects light.
template <int D>
struct PointLight {
  using Cone = LightCone<D>;
  std::string name;
  Vec<D> position;  // world
  double radius = 0;
  Rgb intensity;  // [W/sr] on a spot's axis; [W/rad] in 2D
  std::optional<Cone> cone;

  // light.h describes these functions.
  void check() const;
  std::vector<Vec<D>> corners() const;
  void to_frame(const Vec<D>& center, double scale);
  Rgb amount() const { return intensity; }
  std::optional<Vec<D>> place() const { return position; }
  double power(const BoundingSphere<D>& bounds) const;
  double largest_flux(const BoundingSphere<D>& bounds) const;
  double near_irradiance() const;
  LightSample<D> sample(const Vec<D>& from, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(const BoundingSphere<D>& bounds, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  LightSource<D> source(const std::array<double, 2>& u) const;
  Rgb radiance_along(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;
  double width() const;
  double aspect() const { return 1; }
  LightSource<D> light_point(const std::array<double, 2>& u) const;

 private:
  double share(const Vec<D>& direction) const { return cone ? cone->share(direction) : 1; }
  double emitted_angle() const;
};

}  // namespace leaflight
