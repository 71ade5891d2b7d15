// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/scene/scene.h"

#include <cstring>

#include "arrays.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

using TriangleArray = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;
using VertexArray = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Triple = std::array<double, 3>;

Mesh make_mesh(const std::string& name, const VertexArray& vertices, const TriangleArray& triangles,
               const Triple& albedo) {
  if (vertices.ndim() != 2 || vertices.shape(1) != 3 || triangles.ndim() != 2 ||
      triangles.shape(1) != 3) {
    throw Error("The vertices and triangles of the mesh '" + name +
                "' must be arrays of shape (n, 3).");
  }
  Mesh mesh;
  mesh.name = name;
  mesh.vertices.resize(vertices.shape(0));
  mesh.triangles.resize(triangles.shape(0));
  std::memcpy(static_cast<void*>(mesh.vertices.data()), vertices.data(), vertices.nbytes());
  std::memcpy(mesh.triangles.data(), triangles.data(), triangles.nbytes());
  mesh.albedo = to_triple<Rgb>(albedo);
  return mesh;
}

RectangleLight make_light(const std::string& name, const Triple& corner, const Triple& edge_u,
                          const Triple& edge_v, const Triple& radiance) {
  return {name, to_triple<Vec3>(corner), to_triple<Vec3>(edge_u), to_triple<Vec3>(edge_v),
          to_triple<Rgb>(radiance)};
}

Scene make_scene(const Field<3>& field, const Triple& leaf_albedo, std::vector<Mesh> meshes,
                 std::vector<RectangleLight> lights, std::pair<double, double> isovalues) {
  Scene scene{field,
              to_triple<Rgb>(leaf_albedo),
              std::move(meshes),
              std::move(lights),
              {isovalues.first, isovalues.second}};
  validate(scene);
  return scene;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<Mesh>(module, "Mesh", "A triangle mesh of the surroundings, Lambertian on both sides.")
      .def(py::init(&make_mesh), py::arg("name"), py::arg("vertices"), py::arg("triangles"),
           py::arg("albedo"),
           "vertices: (n, 3) world; triangles: (m, 3) indices; albedo: linear RGB in 0..1.")
      .def_readonly("name", &Mesh::name)
      .def_property_readonly("albedo", [](const Mesh& m) { return from_triple(m.albedo); })
      .def_property_readonly("vertices",
                             [](const Mesh& m) {
                               return py::array_t<float>(
                                   {static_cast<py::ssize_t>(m.vertices.size()), py::ssize_t{3}},
                                   reinterpret_cast<const float*>(m.vertices.data()));
                             })
      .def_property_readonly("triangles", [](const Mesh& m) {
        return py::array_t<std::uint32_t>(
            {static_cast<py::ssize_t>(m.triangles.size()), py::ssize_t{3}},
            reinterpret_cast<const std::uint32_t*>(m.triangles.data()));
      });

  py::class_<RectangleLight>(module, "RectangleLight",
                             "Emits the given radiance from corner + s edge_u + t edge_v towards "
                             "edge_u x edge_v; it does\n"
                             "not block light.")
      .def(py::init(&make_light), py::arg("name"), py::arg("corner"), py::arg("edge_u"),
           py::arg("edge_v"), py::arg("radiance"),
           "corner, edge_u, edge_v: world; radiance: linear RGB, W/(m^2 sr).")
      .def_readonly("name", &RectangleLight::name)
      .def_property_readonly("corner",
                             [](const RectangleLight& l) { return from_triple(l.corner); })
      .def_property_readonly("edge_u",
                             [](const RectangleLight& l) { return from_triple(l.edge_u); })
      .def_property_readonly("edge_v",
                             [](const RectangleLight& l) { return from_triple(l.edge_v); })
      .def_property_readonly("radiance",
                             [](const RectangleLight& l) { return from_triple(l.radiance); });

  py::class_<Scene>(module, "Scene", "A field, what surrounds it, and the isovalues to light.")
      .def(py::init(&make_scene), py::arg("field"), py::arg("leaf_albedo"), py::arg("meshes"),
           py::arg("lights"), py::arg("isovalues"),
           "leaf_albedo: linear RGB in 0..1; isovalues: (low, high) in data units. Raises\n"
           "LeaflightError naming the object that is wrong.");
}

}  // namespace leaflight::python
