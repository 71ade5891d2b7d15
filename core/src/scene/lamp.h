// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "math/affine.h"
#include "scene/facet.h"
#include "scene/texture.h"

namespace leaflight {

// A rectangle, the ellipse within it, or a segment in the plane, that emits the same radiance
// [W/(m^2 sr)] from each of its points into the half space of its normal. Like Blender's area lamp
// it neither blocks nor reflects light.
template <int D>
struct AreaLight {
  std::string name;
  Vec<D> corner;                                              // world
  std::array<Vec<D>, static_cast<std::size_t>(D - 1)> edges;  // world
  Rgb radiance;
  bool ellipse = false;  // in space only

  // u in [0,1)^2, uniform over the area; in the plane the second is not used.
  Vec<D> point(const std::array<double, 2>& u) const;
  double area() const;
  Vec<D> normal() const { return scaled_normal(edges).normalized(); }
};

// A sphere (a circle in the plane) that shines alike in all directions, or into a cone: Blender's
// point and spot lamps. It neither blocks nor reflects light.
template <int D>
struct PointLight {
  struct Cone {
    Vec<D> axis;        // unit
    double cosine = 0;  // of the half angle
    double blend = 0;   // in [0,1]: the part of 1 - cosine over which the edge is indirect
    bool cosine_falloff = false;  // Blender 3.4's spots also fade with the cosine to the axis
  };
  std::string name;
  Vec<D> position;  // world
  double radius = 0;
  Rgb intensity;  // [W/sr], on a spot's axis; [W/rad] in the plane
  std::optional<Cone> cone;
};

// Parallel light, or light from a disc of directions of the given angular diameter.
template <int D>
struct SunLight {
  std::string name;
  Vec<D> direction;  // unit, in which the light travels
  Rgb irradiance;    // [W/m^2] on a surface that faces it
  double angle = 0;  // diameter in radians, below pi
};

template <int D>
using Light = std::variant<AreaLight<D>, PointLight<D>, SunLight<D>>;

// Light from all around: one radiance, or a latitude-longitude image of it.
template <int D>
struct Environment {
  std::string name = "world";
  Rgb radiance{0};                       // [W/(m^2 sr)]; multiplies the image
  std::shared_ptr<const Texture> image;  // in space only; null: constant
  // Turns directions of the world into those of the image, whose centre column is seen along +x and
  // whose upper rows towards +z, as in Blender; the identity if there is no image.
  Affine<D> world_to_image;
};

}  // namespace leaflight
