// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/bounding_sphere.h"
#include "base/facet.h"
#include "lights/light_sample.h"

namespace leaflight {

// A rectangle, an ellipse in it, or in 2D a segment, which emits constant radiance [W/(m^2 sr)]
// into the half space of its normal. Like Blender's area lamp, it neither blocks nor reflects
// light.
template <int D>
struct AreaLight {
  std::string name;
  Vec<D> corner;                                              // world
  std::array<Vec<D>, static_cast<std::size_t>(D - 1)> edges;  // world
  Rgb radiance;
  bool ellipse = false;  // 3D only

  // Maps u in [0,1)^2 to a point, uniform over the area; 2D ignores the second number.
  Vec<D> point(const std::array<double, 2>& u) const;
  double area() const;
  Vec<D> normal() const { return scaled_normal(edges).normalized(); }

  // light.h describes these functions.
  void check() const;
  std::vector<Vec<D>> corners() const;
  void to_frame(const Vec<D>& center, double scale);
  Rgb amount() const { return radiance; }
  std::optional<Vec<D>> place() const;
  double power(const BoundingSphere<D>& bounds) const;
  double largest_flux(const BoundingSphere<D>& bounds) const;
  double near_irradiance() const;
  LightSample<D> sample(const Vec<D>& from, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(const BoundingSphere<D>& bounds, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  LightSource<D> source(const std::array<double, 2>& u) const;
  Rgb radiance_along(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;
  double width() const;
  double aspect() const;
  LightSource<D> light_point(const std::array<double, 2>& u) const { return source(u); }
};

}  // namespace leaflight
