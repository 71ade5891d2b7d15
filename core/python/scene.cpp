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

Mesh<3> make_mesh(const std::string& name, const VertexArray& vertices,
                  const TriangleArray& triangles, const Triple& albedo) {
  if (vertices.ndim() != 2 || vertices.shape(1) != 3 || triangles.ndim() != 2 ||
      triangles.shape(1) != 3) {
    throw Error("The vertices and triangles of the mesh '" + name +
                "' must be arrays of shape (n, 3).");
  }
  Mesh<3> mesh;
  mesh.name = name;
  mesh.vertices.resize(vertices.shape(0));
  mesh.facets.resize(triangles.shape(0));
  std::memcpy(static_cast<void*>(mesh.vertices.data()), vertices.data(), vertices.nbytes());
  std::memcpy(mesh.facets.data(), triangles.data(), triangles.nbytes());
  mesh.albedo = to_triple<Rgb>(albedo);
  return mesh;
}

RectangleLight<3> make_light(const std::string& name, const Triple& corner, const Triple& edge_u,
                             const Triple& edge_v, const Triple& radiance) {
  return {name,
          to_triple<Vec3>(corner),
          {to_triple<Vec3>(edge_u), to_triple<Vec3>(edge_v)},
          to_triple<Rgb>(radiance)};
}

Scene<3> make_scene(const Field<3>& field, const Triple& leaf_albedo, std::vector<Mesh<3>> meshes,
                    std::vector<RectangleLight<3>> lights, std::pair<double, double> isovalues) {
  Scene<3> scene{field,
                 to_triple<Rgb>(leaf_albedo),
                 std::move(meshes),
                 std::move(lights),
                 {isovalues.first, isovalues.second}};
  validate(scene);
  return scene;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<Mesh<3>>(module, "Mesh",
                      "A triangle mesh of the surroundings, Lambertian on both sides.")
      .def(py::init(&make_mesh), py::arg("name"), py::arg("vertices"), py::arg("triangles"),
           py::arg("albedo"),
           "vertices: (n, 3) world; triangles: (m, 3) indices; albedo: linear RGB in 0..1.")
      .def_readonly("name", &Mesh<3>::name)
      .def_property_readonly("albedo", [](const Mesh<3>& m) { return from_triple(m.albedo); })
      .def_property_readonly("vertices",
                             [](const Mesh<3>& m) {
                               return py::array_t<float>(
                                   {static_cast<py::ssize_t>(m.vertices.size()), py::ssize_t{3}},
                                   reinterpret_cast<const float*>(m.vertices.data()));
                             })
      .def_property_readonly("triangles", [](const Mesh<3>& m) {
        return py::array_t<std::uint32_t>(
            {static_cast<py::ssize_t>(m.facets.size()), py::ssize_t{3}},
            reinterpret_cast<const std::uint32_t*>(m.facets.data()));
      });

  py::class_<RectangleLight<3>>(
      module, "RectangleLight",
      "Emits the given radiance from corner + s edge_u + t edge_v towards "
      "edge_u x edge_v; it does\n"
      "not block light.")
      .def(py::init(&make_light), py::arg("name"), py::arg("corner"), py::arg("edge_u"),
           py::arg("edge_v"), py::arg("radiance"),
           "corner, edge_u, edge_v: world; radiance: linear RGB, W/(m^2 sr).")
      .def_readonly("name", &RectangleLight<3>::name)
      .def_property_readonly("corner",
                             [](const RectangleLight<3>& l) { return from_triple(l.corner); })
      .def_property_readonly("edge_u",
                             [](const RectangleLight<3>& l) { return from_triple(l.edges[0]); })
      .def_property_readonly("edge_v",
                             [](const RectangleLight<3>& l) { return from_triple(l.edges[1]); })
      .def_property_readonly("radiance",
                             [](const RectangleLight<3>& l) { return from_triple(l.radiance); });

  py::class_<Scene<3>>(module, "Scene", "A field, what surrounds it, and the isovalues to light.")
      .def(py::init(&make_scene), py::arg("field"), py::arg("leaf_albedo"), py::arg("meshes"),
           py::arg("lights"), py::arg("isovalues"),
           "leaf_albedo: linear RGB in 0..1; isovalues: (low, high) in data units. Raises\n"
           "LeaflightError naming the object that is wrong.");
}

}  // namespace leaflight::python
