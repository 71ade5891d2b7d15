// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/scene/scene.h"

#include <cmath>
#include <sstream>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_albedo(const Rgb& albedo, const std::string& of) {
  for (int i = 0; i < 3; ++i) {
    if (!(albedo[i] >= 0 && albedo[i] <= 1)) {
      std::ostringstream text;
      text << "The albedo of " << of << " is " << albedo[i]
           << " in one channel; choose values between 0 and 1.";
      throw Error(text.str());
    }
  }
}

void check_mesh(const Mesh& mesh) {
  const std::string name = "the mesh '" + mesh.name + "'";
  check_albedo(mesh.albedo, name);
  if (mesh.triangles.empty()) {
    throw Error("There are no faces in " + name + "; remove it or give it faces.");
  }
  for (const auto& vertex : mesh.vertices) {
    if (!is_finite(Vec3(vertex))) {
      throw Error("A vertex of " + name + " is not a finite number; repair the mesh.");
    }
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= mesh.vertices.size()) {
        throw Error("A face of " + name + " refers to vertex " + std::to_string(v) + " of " +
                    std::to_string(mesh.vertices.size()) + "; repair the mesh.");
      }
    }
  }
}

void check_light(const RectangleLight& light) {
  const std::string name = "The light '" + light.name + "'";
  if (!is_finite(light.corner) || !is_finite(light.edge_u) || !is_finite(light.edge_v)) {
    throw Error(name + " has a position or size that is not a finite number; correct it.");
  }
  if (!(light.area() > 0)) {
    throw Error(name + " has no area; give it a width and a height.");
  }
  for (int i = 0; i < 3; ++i) {
    if (!(light.radiance[i] >= 0) || !std::isfinite(light.radiance[i])) {
      throw Error(name + " has a negative or non-finite radiance; choose one that is 0 or more.");
    }
  }
}

}  // namespace

void validate(const Scene& scene) {
  const Field<3>& field = scene.field;
  const IsovalueWindow& window = scene.window;
  std::ostringstream text;
  text << "The isovalue window " << window.min << " to " << window.max;
  if (!(window.min < window.max) || !std::isfinite(window.height())) {
    throw Error(text.str() + " is empty; its upper end must be above its lower end.");
  }
  if (window.max <= field.min || window.min > field.max) {
    text << " lies outside the data, which range from " << field.min << " to " << field.max
         << "; choose a window that overlaps them.";
    throw Error(text.str());
  }
  check_albedo(scene.leaf_albedo, "the isosurfaces");
  for (const Mesh& mesh : scene.meshes) check_mesh(mesh);
  for (const RectangleLight& light : scene.lights) check_light(light);
  Real power = 0;
  for (const RectangleLight& light : scene.lights) {
    power += average(light.radiance) * static_cast<Real>(light.area());
  }
  if (!(power > 0)) {
    throw Error("The scene has no light, so every isosurface would be black; add an area light.");
  }
}

}  // namespace leaflight
