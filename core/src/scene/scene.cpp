// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/scene/scene.h"

#include <cmath>
#include <sstream>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

template <class V>
bool is_finite(const V& v) {
  for (unsigned a = 0; a < V::dimensions(); ++a) {
    if (!std::isfinite(v[a])) return false;
  }
  return true;
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

template <int D>
void check_mesh(const Mesh<D>& mesh) {
  const std::string name = "the mesh '" + mesh.name + "'";
  check_albedo(mesh.albedo, name);
  if (mesh.facets.empty()) {
    throw Error("There are no faces in " + name + "; remove it or give it faces.");
  }
  for (const auto& vertex : mesh.vertices) {
    if (!is_finite(vertex)) {
      throw Error("A vertex of " + name + " is not a finite number; repair the mesh.");
    }
  }
  for (const auto& facet : mesh.facets) {
    for (const std::uint32_t v : facet) {
      if (v >= mesh.vertices.size()) {
        throw Error("A face of " + name + " refers to vertex " + std::to_string(v) + " of " +
                    std::to_string(mesh.vertices.size()) + "; repair the mesh.");
      }
    }
  }
}

template <int D>
void check_light(const RectangleLight<D>& light) {
  const std::string name = "The light '" + light.name + "'";
  bool finite = is_finite(light.corner);
  for (const Vec<D>& edge : light.edges) finite = finite && is_finite(edge);
  if (!finite) {
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

template <int D>
void validate(const Scene<D>& scene) {
  const Field<D>& field = scene.field;
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
  for (const Mesh<D>& mesh : scene.meshes) check_mesh(mesh);
  for (const RectangleLight<D>& light : scene.lights) check_light(light);
  Real power = 0;
  for (const RectangleLight<D>& light : scene.lights) {
    power += average(light.radiance) * static_cast<Real>(light.area());
  }
  if (!(power > 0)) {
    throw Error("The scene has no light, so every isosurface would be black; add an area light.");
  }
}

template void validate<2>(const Scene<2>&);
template void validate<3>(const Scene<3>&);

}  // namespace leaflight
