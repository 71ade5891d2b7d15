// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "leaflight/field/field.h"

namespace leaflight {

// A triangle mesh of the surroundings, Lambertian on both sides. It stands in every leaf: the
// thesis's prism over the range of h (4.3.3).
struct Mesh {
  std::string name;
  std::vector<Vec<3, float>> vertices;  // world
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Rgb albedo;  // in [0,1]
};

// Emits the same radiance [W/(m^2 sr)] from each point of corner + s edge_u + t edge_v into the
// half space of edge_u x edge_v. It neither blocks nor reflects light, like Blender's area lamp.
struct RectangleLight {
  std::string name;
  Vec3 corner, edge_u, edge_v;  // world
  Rgb radiance;

  Vec3 point(double s, double t) const { return corner + edge_u * s + edge_v * t; }
  double area() const { return edge_u.cross(edge_v).length(); }
  Vec3 normal() const { return edge_u.cross(edge_v).normalized(); }
};

struct IsovalueWindow {
  double min = 0;
  double max = 0;

  double height() const { return max - min; }
  bool contains(double c) const { return min <= c && c <= max; }
};

// What is lit: the leaves of a field within a window, and what surrounds them.
struct Scene {
  Field<3> field;
  Rgb leaf_albedo;  // in [0,1]
  std::vector<Mesh> meshes;
  std::vector<RectangleLight> lights;
  IsovalueWindow window;
};

// Throws Error with one sentence that names the offending object.
void validate(const Scene& scene);

}  // namespace leaflight
