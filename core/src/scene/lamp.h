// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/affine.h"
#include "scene/facet.h"
#include "scene/texture.h"

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
};

// A sphere (a circle in 2D) that emits equally in all directions, or into a cone: Blender's point
// and spot lamps. It neither blocks nor reflects light.
template <int D>
struct PointLight {
  struct Cone {
    Vec<D> axis;                  // unit
    double cosine = 0;            // cosine of the half angle
    double blend = 0;             // in [0,1]: part of 1 - cosine over which the edge fades
    bool cosine_falloff = false;  // true for Blender 3.4's spots, which also fade with the cosine
  };
  std::string name;
  Vec<D> position;  // world
  double radius = 0;
  Rgb intensity;  // [W/sr] on a spot's axis; [W/rad] in 2D
  std::optional<Cone> cone;
};

// Parallel light, or light from a disc of directions with the given angular diameter.
template <int D>
struct SunLight {
  std::string name;
  Vec<D> direction;  // unit, away from the sun
  Rgb irradiance;    // [W/m^2] on a surface that faces it
  double angle = 0;  // diameter in radians, below pi
};

template <int D>
using Light = std::variant<AreaLight<D>, PointLight<D>, SunLight<D>>;

// The environment light: a constant radiance, or a latitude-longitude image.
template <int D>
struct Environment {
  std::string name = "world";
  Rgb radiance{0};                       // [W/(m^2 sr)]; multiplies the image
  std::shared_ptr<const Texture> image;  // 3D only; null: constant
  // The rotation from world directions to those of the image; the identity without an image. As in
  // Blender, the image's center column is along +x, and its upper rows are towards +z.
  Affine<D> world_to_image;
};

}  // namespace leaflight
