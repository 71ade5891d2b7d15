// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include "arrays.h"
#include "bindings.h"
#include "leaflight/surface/marching_cubes.h"
#include "leaflight/surface/marching_squares.h"
#include "leaflight/surface/project.h"
#include "leaflight/transport/exposure.h"

namespace leaflight::python {

void bind_surface(py::module_& module) {
  module.def(
      "contour",
      [](const Field<3>& field, double isovalue) {
        IsosurfaceMesh mesh;
        {
          const py::gil_scoped_release unlocked;
          mesh = contour(field, isovalue);
        }
        return arrays_of(std::move(mesh));
      },
      py::arg("field"), py::arg("isovalue"),
      "Marching cubes: (vertices (n, 3) world, outward unit normals (n, 3), triangles (m, 3)).");
  module.def(
      "contour2",
      [](const Field<2>& field, double isovalue) {
        IsolineMesh mesh;
        {
          const py::gil_scoped_release unlocked;
          mesh = contour(field, isovalue);
        }
        const auto n = static_cast<py::ssize_t>(mesh.vertices.size());
        const auto m = static_cast<py::ssize_t>(mesh.segments.size());
        return py::make_tuple(adopt<float>(std::move(mesh.vertices), {n, 2}),
                              adopt<float>(std::move(mesh.normals), {n, 2}),
                              adopt<std::int32_t>(std::move(mesh.segments), {m, 2}));
      },
      py::arg("field"), py::arg("isovalue"),
      "Marching squares: (vertices (n, 2) world, outward unit normals (n, 2), segments (m, 2)).");
  module.def(
      "normals",
      [](const Field<3>& field, const DoubleArray& array) {
        const std::vector<Vec3> points = to_points<3>(array);
        std::vector<Vec<3, float>> normals(points.size());
        {
          const py::gil_scoped_release unlocked;
          tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            normals[i] =
                Vec<3, float>(shading_normal(field, field.world_to_index.point(points[i])));
          });
        }
        const auto n = static_cast<py::ssize_t>(normals.size());
        return adopt<float>(std::move(normals), {n, 3});
      },
      py::arg("field"), py::arg("points"),
      "Outward unit normals float32 (n, 3) with which leaves are shaded at world points (n, 3) of\n"
      "the domain; zero where there is none.");
  module.def(
      "project_to_leaf",
      [](const Field<3>& field, const DoubleArray& array, double isovalue) {
        std::vector<Vec3> points = to_points<3>(array);
        {
          const py::gil_scoped_release unlocked;
          tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            points[i] = project_to_leaf(field, points[i], isovalue);
          });
        }
        const auto n = static_cast<py::ssize_t>(points.size());
        return adopt<double>(std::move(points), {n, 3});
      },
      py::arg("field"), py::arg("points"), py::arg("isovalue"),
      "The points of the trilinear leaf nearest along the gradient to world points (n, 3), within\n"
      "two voxels; points without one are returned as they are.");
  module.def(
      "exposed",
      [](const Field<3>& field, const DoubleArray& array, double isovalue, int directions,
         std::uint64_t seed) {
        const std::vector<Vec3> points = to_points<3>(array);
        std::vector<std::uint8_t> result;
        {
          const py::gil_scoped_release unlocked;
          result = exposed(field, points, isovalue, directions, seed);
        }
        const auto n = static_cast<py::ssize_t>(result.size());
        return adopt<std::uint8_t>(std::move(result), {n});
      },
      py::arg("field"), py::arg("points"), py::arg("isovalue"), py::arg("directions") = 32,
      py::arg("seed") = 0,
      "uint8 (n,): 1 where one of `directions` random rays from the leaf's outer side leaves the\n"
      "domain, so that the world point can be seen from outside.");
}

}  // namespace leaflight::python
