// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "arrays.h"
#include "base/sampling.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

using Stops = std::vector<std::pair<double, Tuple<3>>>;
template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

std::shared_ptr<Texture> make_texture(const Array<float>& pixels) {
  if (pixels.ndim() != 3 || pixels.shape(2) != 3) {
    throw Error("An image must be an array [row, column, RGB].");
  }
  constexpr int largest_side = 1 << 16;
  if (pixels.shape(0) > largest_side || pixels.shape(1) > largest_side) {
    throw Error("An image may have 65536 pixels a side; use a smaller one.");
  }
  auto texture = std::make_shared<Texture>();
  texture->height = static_cast<int>(pixels.shape(0));
  texture->width = static_cast<int>(pixels.shape(1));
  texture->pixels.resize(pixels.size() / 3);
  std::memcpy(static_cast<void*>(texture->pixels.data()), pixels.data(), pixels.nbytes());
  return texture;
}

Scattering scattering_from(const std::string& name, const std::string& owner) {
  if (name == "diffuse") return Scattering::diffuse;
  if (name == "mirror") return Scattering::mirror;
  if (name == "glass") return Scattering::glass;
  throw Error("The scattering of " + owner + " is '" + name +
              "'; choose diffuse, mirror or glass.");
}

ColorRamp to_ramp(const Stops& stops) {
  std::vector<ColorRamp::Stop> all;
  for (const auto& [position, color] : stops) all.push_back({position, to_color(color)});
  return ColorRamp(std::move(all));
}

// Copies rows of numbers to structs of the same layout.
template <class Element, class Scalar>
std::vector<Element> to_elements(const Array<Scalar>& array, std::vector<py::ssize_t> row,
                                 const std::string& what) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(row.size()) + 1;
  std::string shape = "(n";
  for (std::size_t a = 0; a < row.size(); ++a) {
    fits = fits && array.shape(a + 1) == row[a];
    shape += ", " + std::to_string(row[a]);
  }
  if (!fits) throw Error("The " + what + " must be an array of shape " + shape + ").");
  std::vector<Element> elements(array.shape(0));
  if (!elements.empty()) {
    std::memcpy(static_cast<void*>(elements.data()), array.data(), array.nbytes());
  }
  return elements;
}

template <int D>
Mesh<D> make_mesh(const std::string& name, const Array<float>& vertices,
                  const Array<std::uint32_t>& facets, const Tuple<3>& albedo,
                  const std::string& scattering, double ior, const Tuple<3>& emission,
                  const std::optional<std::shared_ptr<Texture>>& texture,
                  const std::optional<Array<float>>& uv) {
  const std::string owner = "the mesh '" + name + "'";
  if (uv.has_value() != texture.has_value()) {
    throw Error(uv ? "There are texture coordinates but no texture for " + owner + "; give both."
                   : "There is a texture but no texture coordinates for " + owner +
                         "; unwrap the mesh.");
  }
  Mesh<D> mesh;
  mesh.name = name;
  mesh.vertices = to_elements<Vec<D, float>>(vertices, {D}, "vertices of " + owner);
  mesh.facets = to_elements<typename Mesh<D>::Facet>(
      facets, {D}, (D == 2 ? "segments of " : "triangles of ") + owner);
  mesh.albedo = to_color(albedo);
  mesh.scattering = scattering_from(scattering, owner);
  mesh.ior = ior;
  mesh.emission = to_color(emission);
  if (texture) mesh.texture = *texture;
  if (uv) mesh.uv = to_elements<typename Mesh<D>::FacetUv>(*uv, {D, 2}, "uv of " + owner);
  return mesh;
}

template <int D>
PointLight<D> make_point_light(const std::string& name, const Tuple<D>& position, double radius,
                               const Tuple<3>& intensity, const std::optional<Tuple<D>>& axis,
                               double angle, double blend, bool cosine_falloff) {
  PointLight<D> light{name, to_vec<D>(position), radius, to_color(intensity), {}};
  if (!axis) return light;
  if (!(angle > 0 && angle < 2 * pi)) {
    throw Error("The light '" + name +
                "' has a cone whose angle is not between 0 and 360 degrees; correct it.");
  }
  light.cone = {to_vec<D>(*axis), std::cos(0.5 * angle), blend, cosine_falloff};
  return light;
}

template <int D>
SunLight<D> make_sun_light(const std::string& name, const Tuple<D>& direction,
                           const Tuple<3>& irradiance, double angle) {
  return {name, to_vec<D>(direction), to_color(irradiance), angle};
}

Environment<3> make_environment(const std::string& name, const Tuple<3>& radiance,
                                std::shared_ptr<Texture> image,
                                const std::array<Tuple<3>, 3>& world_to_image) {
  Environment<3> environment{name, to_color(radiance), std::move(image), {}};
  for (int row = 0; row < 3; ++row) {
    for (int a = 0; a < 3; ++a) environment.world_to_image.column[a][row] = world_to_image[row][a];
  }
  const double volume = determinant(environment.world_to_image);
  if (!std::isfinite(volume) || volume == 0) {
    throw Error("The orientation of the environment '" + name +
                "' cannot be inverted; correct its matrix.");
  }
  return environment;
}

Environment<2> make_environment_2(const std::string& name, const Tuple<3>& radiance) {
  return {name, to_color(radiance), nullptr, {{Vec<2>(1, 0), Vec<2>(0, 1)}}};
}

template <class Value>
bool add_channel(const py::array& array, std::vector<VolumeTexture<3>::Channel>& channels) {
  if (!py::isinstance<VoxelArray<Value>>(array)) return false;
  const auto values = py::reinterpret_borrow<VoxelArray<Value>>(array);
  channels.push_back({values.data(), kept(values)});
  return true;
}

std::shared_ptr<VolumeTexture<3>> make_volume_texture(const std::vector<py::array>& channels,
                                                      const DoubleArray& index_to_world,
                                                      const Stops& colors, bool nearest) {
  auto texture = std::make_shared<VolumeTexture<3>>();
  for (const py::array& array : channels) {
    if (array.ndim() != 3 || array.size() == 0) {
      throw Error("The values of a texture must be an array [z, y, x].");
    }
    Index<3> dims;
    for (int a = 0; a < 3; ++a) dims[a] = to_dim(array.shape(2 - a));
    if (!texture->channels.empty() && dims != texture->dims) {
      throw Error("The channels of a texture differ in their shape; give three equal ones.");
    }
    texture->dims = dims;
    if (!(add_channel<float>(array, texture->channels) ||
          add_channel<std::uint8_t>(array, texture->channels) ||
          add_channel<std::int16_t>(array, texture->channels) ||
          add_channel<std::uint16_t>(array, texture->channels))) {
      throw Error("The values of a texture must be float32, uint8, int16 or uint16.");
    }
  }
  if (texture->channels.size() != 1 && texture->channels.size() != 3) {
    throw Error("A texture has one channel, or three for red, green and blue.");
  }
  const Affine<3> to_world = to_affine<3>(index_to_world);
  const double size = determinant(to_world);
  if (!std::isfinite(size) || size == 0) {
    throw Error("The transform of a texture cannot be inverted; correct its matrix.");
  }
  texture->to_texture = inverse(to_world);
  texture->colors = to_ramp(colors);
  texture->nearest = nearest;
  return texture;
}

// Returns a copy that takes index positions of a field in place of world positions.
std::shared_ptr<VolumeTexture<3>> texture_on(const VolumeTexture<3>& texture,
                                             const Field<3>& field) {
  auto copy = std::make_shared<VolumeTexture<3>>(texture);
  const Affine<3>& to_world = field.index_to_world;
  copy->to_texture.origin = texture.to_texture.point(to_world.origin);
  for (int a = 0; a < 3; ++a) {
    copy->to_texture.column[a] = texture.to_texture.vector(to_world.column[a]);
  }
  return copy;
}

template <int D>
Volume<D> make_volume(const std::string& name, const Field<D>& field, const Stops& albedo,
                      const Stops& emission, const std::string& scattering, double ior,
                      double offset, double scale) {
  return {name,
          field,
          to_ramp(albedo),
          to_ramp(emission),
          scattering_from(scattering, "the volume '" + name + "'"),
          ior,
          offset,
          scale,
          nullptr};
}

template <int D>
Scene<D> make_scene(std::vector<Volume<D>> volumes, std::vector<Mesh<D>> meshes,
                    std::vector<Light<D>> lights, std::pair<double, double> isovalues,
                    std::optional<Environment<D>> environment) {
  Scene<D> scene{std::move(volumes),
                 std::move(meshes),
                 std::move(lights),
                 std::move(environment),
                 {isovalues.first, isovalues.second}};
  validate(scene);
  return scene;
}

const Tuple<3> black{0, 0, 0};

template <int D>
void bind_area_light(py::module_& module, const std::string& name) {
  py::class_<AreaLight<D>> area_light(
      module, name.c_str(),
      D == 2 ? "A segment that emits to the left of its edge. It neither blocks nor reflects light."
             : "A rectangle, or the ellipse in it, that emits towards edge_u x edge_v. It neither\n"
               "blocks nor reflects light.");
  const char* doc = "Positions: world; radiance: linear RGB, W/(m^2 sr).";
  if constexpr (D == 2) {
    area_light.def(
        py::init([](const std::string& light, const Tuple<2>& corner, const Tuple<2>& edge,
                    const Tuple<3>& radiance) {
          return AreaLight<2>{light, to_vec<2>(corner), {to_vec<2>(edge)}, to_color(radiance)};
        }),
        py::arg("name"), py::arg("corner"), py::arg("edge"), py::arg("radiance"), doc);
  } else {
    area_light.def(
        py::init([](const std::string& light, const Tuple<3>& corner, const Tuple<3>& edge_u,
                    const Tuple<3>& edge_v, const Tuple<3>& radiance, bool ellipse) {
          return AreaLight<3>{light,
                              to_vec<3>(corner),
                              {to_vec<3>(edge_u), to_vec<3>(edge_v)},
                              to_color(radiance),
                              ellipse};
        }),
        py::arg("name"), py::arg("corner"), py::arg("edge_u"), py::arg("edge_v"),
        py::arg("radiance"), py::arg("ellipse") = false, doc);
  }
  area_light.def_readonly("name", &AreaLight<D>::name);
}

template <int D>
void bind_lights(py::module_& module, const std::string& suffix) {
  bind_area_light<D>(module, "AreaLight" + suffix);

  py::class_<PointLight<D>>(module, ("PointLight" + suffix).c_str(),
                            "A sphere that emits equally in all directions, or within a cone.")
      .def(
          py::init(&make_point_light<D>), py::arg("name"), py::arg("position"), py::arg("radius"),
          py::arg("intensity"), py::arg("axis") = py::none(), py::arg("angle") = 0.0,
          py::arg("blend") = 0.0, py::arg("cosine_falloff") = false,
          "position: world; intensity: linear RGB, W/sr; axis: unit, of a spot's cone; angle: its\n"
          "opening in radians; blend: the soft part of the cone, 0..1.")
      .def_readonly("name", &PointLight<D>::name);

  py::class_<SunLight<D>>(module, ("SunLight" + suffix).c_str(), "Parallel light.")
      .def(py::init(&make_sun_light<D>), py::arg("name"), py::arg("direction"),
           py::arg("irradiance"), py::arg("angle") = 0.0,
           "direction: unit, in which light travels; irradiance: linear RGB, W/m^2 on a surface "
           "that\n"
           "faces it; angle: diameter of its disc in radians.")
      .def_readonly("name", &SunLight<D>::name);

  py::class_<Environment<D>> environment(module, ("Environment" + suffix).c_str(),
                                         "The environment light.");
  if constexpr (D == 2) {
    environment.def(py::init(&make_environment_2), py::arg("name"), py::arg("radiance"),
                    "radiance: linear RGB, W/(m rad).");
  } else {
    environment.def(
        py::init(&make_environment), py::arg("name"), py::arg("radiance"),
        py::arg("image") = py::none(),
        py::arg("world_to_image") = std::array<Tuple<3>, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
        "radiance: linear RGB, W/(m^2 sr), multiplies the image, a latitude-longitude\n"
        "Texture; world_to_image: 3 x 3.");
  }
  environment.def_readonly("name", &Environment<D>::name);
}

template <int D>
void bind_objects(py::module_& module, const std::string& suffix) {
  py::class_<Mesh<D>>(module, ("Mesh" + suffix).c_str(),
                      "A mesh of the walls, with the same material on both sides.")
      .def(
          py::init(&make_mesh<D>), py::arg("name"), py::arg("vertices"),
          py::arg(D == 2 ? "segments" : "triangles"), py::arg("albedo"),
          py::arg("scattering") = "diffuse", py::arg("ior") = 1.5, py::arg("emission") = black,
          py::arg("texture") = py::none(), py::arg("uv") = py::none(),
          "vertices: (n, D) world; triangles or segments: (m, D) indices; albedo: linear RGB in\n"
          "0..1; scattering: diffuse, mirror or glass; emission: linear RGB, W/(m^2 sr); texture:\n"
          "Texture that multiplies the albedo; uv: (m, D, 2), per corner.")
      .def_readonly("name", &Mesh<D>::name);

  py::class_<Volume<D>> volume_class(module, ("Volume" + suffix).c_str(),
                                     "A field and the material of its isosurfaces.");
  volume_class
      .def(py::init(&make_volume<D>), py::arg("name"), py::arg("field"), py::arg("albedo"),
           py::arg("emission") = Stops{{0, black}}, py::arg("scattering") = "diffuse",
           py::arg("ior") = 1.5, py::arg("offset") = 0.0, py::arg("scale") = 1.0,
           "albedo, emission: [(common isovalue, linear RGB), ...] in ascending order; the "
           "isosurface\n"
           "coordinate c shows the isovalue offset + scale c.")
      .def_readonly("name", &Volume<D>::name);

  py::class_<Scene<D>>(
      module, ("Scene" + suffix).c_str(),
      "Volumes, the objects around them, and the range of common isovalues to light.")
      .def(py::init(&make_scene<D>), py::arg("volumes"), py::arg("meshes"), py::arg("lights"),
           py::arg("isovalues"), py::arg("environment") = py::none(),
           "isovalues: (low, high) of the common isovalue. Raises LeaflightError with the name\n"
           "of the invalid object.");

  if constexpr (D == 3) {
    volume_class.def(
        "set_texture",
        [](Volume<D>& v, const VolumeTexture<D>& texture) {
          v.texture = texture_on(texture, v.field);
        },
        py::arg("texture"), "Sets the VolumeTexture that multiplies the albedo.");
  }
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<Texture, std::shared_ptr<Texture>>(module, "Texture", "An image over (u, v).")
      .def(py::init(&make_texture), py::arg("pixels"),
           "pixels: float32 [row, column, RGB], linear, bottom row first.");
  py::class_<VolumeTexture<3>, std::shared_ptr<VolumeTexture<3>>>(
      module, "VolumeTexture", "Colors over the domain of a volume.")
      .def(
          py::init(&make_volume_texture), py::arg("channels"), py::arg("index_to_world"),
          py::arg("colors"), py::arg("nearest") = false,
          "channels: one array [z, y, x], C-contiguous, kept by reference, or three of one shape\n"
          "for red, green and blue; float32, uint8, int16 or uint16. index_to_world: 4 x 4.\n"
          "colors: [(value, linear RGB in 0..1), ...] in ascending values; each of three channels\n"
          "takes its component. nearest: takes the value of the nearest voxel, as for labels.\n"
          "It is white where there is no value.")
      .def(
          "at",
          [](const VolumeTexture<3>& texture, const DoubleArray& array) {
            std::vector<Vec<3, float>> colors;
            for (const Vec3& point : to_points<3>(array)) colors.emplace_back(texture.at(point));
            const auto n = static_cast<py::ssize_t>(colors.size());
            return adopt<float>(std::move(colors), {n, 3});
          },
          py::arg("points"), "Returns the colors, float32 (n, 3), at world points (n, 3).")
      .def("on", &texture_on, py::arg("field"),
           "Returns the texture over index positions of a field, for RadianceGrid.with_texture.");
  bind_lights<3>(module, "");
  bind_objects<3>(module, "");
  bind_lights<2>(module, "2");
  bind_objects<2>(module, "2");
}

}  // namespace leaflight::python
