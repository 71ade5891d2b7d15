// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/bounds.h"
#include "base/error.h"
#include "lights/light_checks.h"

namespace leaflight {
namespace {

template <class V>
bool is_finite(const V& v) {
  for (unsigned a = 0; a < V::dimensions(); ++a) {
    if (!std::isfinite(v[a])) return false;
  }
  return true;
}

void check_albedo(const Rgb& albedo, const std::string& name) {
  for (int i = 0; i < 3; ++i) {
    if (!(albedo[i] >= 0 && albedo[i] <= 1)) {
      std::ostringstream text;
      text << "The albedo of " << name << " is " << albedo[i]
           << " in one channel; choose values between 0 and 1.";
      throw Error(text.str());
    }
  }
}

void check_ior(double ior, Scattering scattering, const std::string& name) {
  if (scattering == Scattering::glass && !(ior >= 0.1 && ior <= 10)) {
    std::ostringstream text;
    text << "The refractive index of " << name << " is " << ior << "; choose one from 0.1 to 10.";
    throw Error(text.str());
  }
}

void check_texture(const Texture& texture, const std::string& name) {
  const std::size_t pixels = static_cast<std::size_t>(texture.width) * texture.height;
  if (texture.width < 1 || texture.height < 1 || texture.pixels.size() != pixels) {
    throw Error("The image of " + name + " has no pixels; choose another image.");
  }
  for (const auto& pixel : texture.pixels) {
    for (int i = 0; i < 3; ++i) {
      if (!(pixel[i] >= 0) || !std::isfinite(pixel[i])) {
        throw Error("A pixel of the image of " + name +
                    " is negative or not a finite number; repair the image.");
      }
    }
  }
}

template <int D>
void check_mesh(const Mesh<D>& mesh) {
  const std::string name = "the mesh '" + mesh.name + "'";
  check_albedo(mesh.albedo, name);
  check_ior(mesh.ior, mesh.scattering, name);
  check_light_amount(mesh.emission, "The mesh '" + mesh.name + "'", "emission");
  // Check the geometry.
  if (mesh.facets.empty()) {
    throw Error("There are no faces in " + name + "; remove it or give it faces.");
  }
  for (const auto& vertex : mesh.vertices) {
    if (!within_bounds(vertex)) {
      throw Error("A vertex of " + name +
                  " is not a number or farther than 1e18 from the origin; repair the mesh.");
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
  // Check the texture and its coordinates.
  if (!mesh.texture) return;
  check_texture(*mesh.texture, name);
  for (const auto& pixel : mesh.texture->pixels) check_albedo(mesh.albedo * Rgb(pixel), name);
  if (mesh.uv.size() != mesh.facets.size()) {
    throw Error("The texture of " + name + " has coordinates for " +
                std::to_string(mesh.uv.size()) + " of its " + std::to_string(mesh.facets.size()) +
                " faces; unwrap the mesh.");
  }
  for (const auto& corners : mesh.uv) {
    for (const Imath::V2f& uv : corners) {
      if (!is_finite(uv)) {
        throw Error("A texture coordinate of " + name +
                    " is not a finite number; unwrap the mesh again.");
      }
    }
  }
}

template <int D>
bool has_light(const Scene<D>& scene) {
  for (const Light<D>& light : scene.lights) {
    if (largest(std::visit([](const auto& l) { return l.amount(); }, light)) > 0) return true;
  }
  for (const Mesh<D>& mesh : scene.meshes) {
    if (largest(mesh.emission) > 0) return true;
  }
  for (const Volume<D>& volume : scene.volumes) {
    if (volume.emission.largest() > 0) return true;
  }
  if (!scene.environment || !(largest(scene.environment->radiance) > 0)) return false;
  if (!scene.environment->image) return true;
  const auto& pixels = scene.environment->image->pixels;
  return std::any_of(pixels.begin(), pixels.end(), [](const auto& pixel) {
    return std::max({pixel.x, pixel.y, pixel.z}) > 0;
  });
}

void check_ramp(const ColorRamp& ramp, const std::string& name, const char* what) {
  bool ascending = !ramp.stops.empty();
  for (std::size_t i = 0; i < ramp.stops.size(); ++i) {
    ascending = ascending && std::isfinite(ramp.stops[i].position) &&
                (i == 0 || ramp.stops[i].position > ramp.stops[i - 1].position);
  }
  if (!ascending) {
    throw Error("The stops of the " + std::string(what) + " ramp of " + name +
                " are not in ascending order; sort them.");
  }
}

template <int D>
void check_volume(const Volume<D>& volume, const IsovalueRange& isovalue_range) {
  const std::string name = "the volume '" + volume.name + "'";
  if (!(volume.scale > 0) || !std::isfinite(volume.scale) || !std::isfinite(volume.offset)) {
    throw Error("The range of isovalues of " + name +
                " is empty; its upper end must be above its lower end.");
  }
  const auto [low, high] = volume.isovalues(isovalue_range);
  if (high <= volume.field.min || low > volume.field.max) {
    std::ostringstream text;
    text << "The isovalue range " << low << " to " << high << " lies outside the data of " << name
         << ", which range from " << volume.field.min << " to " << volume.field.max
         << "; choose a range that overlaps them.";
    throw Error(text.str());
  }
  check_ramp(volume.albedo, name, "albedo");
  check_ramp(volume.emission, name, "emission");
  for (const auto& stop : volume.albedo.stops) {
    check_albedo(stop.color, "the isosurfaces of " + name);
  }
  for (const auto& stop : volume.emission.stops) {
    check_light_amount(stop.color, "The volume '" + volume.name + "'", "emission");
  }
  if (volume.texture) {
    check_ramp(volume.texture->colors, name, "texture");
    for (const auto& stop : volume.texture->colors.stops) {
      check_albedo(stop.color, "the texture of " + name);
    }
    if (volume.emission.largest() > 0) {
      throw Error("The isosurfaces of " + name +
                  " emit light and have a texture; remove the emission or the texture.");
    }
  }
  check_ior(volume.ior, volume.scattering, name);
}

}  // namespace

template <int D>
Rgb Mesh<D>::albedo_at(std::size_t facet, double u, double v) const {
  if (!texture) return albedo;
  const FacetUv& corners = uv[facet];
  Imath::V2d at = Imath::V2d(corners[0]) + (Imath::V2d(corners[1]) - Imath::V2d(corners[0])) * u;
  if constexpr (D == 3) at += (Imath::V2d(corners[2]) - Imath::V2d(corners[0])) * v;
  return albedo * texture->at(at.x, at.y);
}

template <int D>
bool has_specular(const Scene<D>& scene) {
  const auto specular = [](const auto& object) { return object.scattering != Scattering::diffuse; };
  return std::any_of(scene.volumes.begin(), scene.volumes.end(), specular) ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(), specular);
}

template <int D>
void validate(const Scene<D>& scene) {
  const IsovalueRange& isovalue_range = scene.isovalue_range;
  if (!(isovalue_range.min < isovalue_range.max) || !std::isfinite(isovalue_range.height())) {
    std::ostringstream text;
    text << "The isovalue range " << isovalue_range.min << " to " << isovalue_range.max
         << " is empty; its upper end must be above its lower end.";
    throw Error(text.str());
  }
  if (scene.volumes.empty() && scene.meshes.empty()) {
    throw Error("The scene is empty; add a volume.");
  }
  for (const Volume<D>& volume : scene.volumes) check_volume(volume, isovalue_range);
  for (const Mesh<D>& mesh : scene.meshes) check_mesh(mesh);
  for (const Light<D>& light : scene.lights) {
    std::visit([](const auto& l) { l.check(); }, light);
  }
  if (scene.environment) {
    const std::string name = "the environment '" + scene.environment->name + "'";
    check_light_amount(scene.environment->radiance,
                       "The environment '" + scene.environment->name + "'", "radiance");
    if (scene.environment->image) check_texture(*scene.environment->image, name);
  }
  if (!has_light(scene)) {
    throw Error(
        "The scene has no light, so every isosurface would be black; add an area light, or give "
        "the world a color.");
  }
}

template struct Mesh<2>;
template struct Mesh<3>;
template bool has_specular<2>(const Scene<2>&);
template bool has_specular<3>(const Scene<3>&);
template void validate<2>(const Scene<2>&);
template void validate<3>(const Scene<3>&);

}  // namespace leaflight
