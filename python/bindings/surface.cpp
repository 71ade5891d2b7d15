// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "mesh_arrays.h"
#include "surface/islands.h"
#include "surface/marching_squares.h"
#include "surface/polygon_edges.h"
#include "surface/project.h"
#include "transport/exposure.h"

namespace leaflight::python {
namespace {

using IndexArray = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

void check_polygons(const IndexArray& polygons, std::int32_t vertices) {
  if (polygons.ndim() != 2 || polygons.shape(1) < 3) {
    throw Error("The polygons must be an array of shape (n, 3) or (n, 4).");
  }
  if (polygons.size() > std::numeric_limits<std::int32_t>::max()) {
    throw Error("The mesh is too large; choose another isovalue or crop the volume.");
  }
  const auto inside = [&](std::int32_t v) { return v >= 0 && v < vertices; };
  if (!std::all_of(polygons.data(), polygons.data() + polygons.size(), inside)) {
    throw Error("A polygon has a vertex that the mesh does not have.");
  }
}

const std::array<std::int32_t, 3>* triangles_of(const IndexArray& polygons) {
  return reinterpret_cast<const std::array<std::int32_t, 3>*>(polygons.data());
}

// Applies a function to each world point and its number; returns float64 (n, 3).
template <class Move>
py::array_t<double> moved_points(const DoubleArray& array, const Move& move) {
  std::vector<Vec3> points = to_points<3>(array);
  {
    const py::gil_scoped_release unlocked;
    tbb::parallel_for(std::size_t{0}, points.size(),
                      [&](std::size_t i) { points[i] = move(i, points[i]); });
  }
  const auto n = static_cast<py::ssize_t>(points.size());
  return adopt<double>(std::move(points), {n, 3});
}

}  // namespace

void bind_surface(py::module_& module) {
  module.def(
      "contour",
      [](const Field<3>& field, double isovalue, bool normals) {
        const std::shared_ptr<LitMesh> mesh = mesh_to_fill();
        {
          const py::gil_scoped_release unlocked;
          contour(field, isovalue, normals, *mesh);
        }
        return mesh_arrays(mesh);
      },
      py::arg("field"), py::arg("isovalue"), py::arg("normals") = true,
      "Marching cubes: (vertices float32 (n, 3) world, outward unit normals (n, 3), triangles "
      "int32\n"
      "(m, 3)), a manifold. Without normals, which take the longest, there is None in their "
      "place.");
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
      "Outward unit normals float32 (n, 3) with which isosurfaces are shaded at world points (n, "
      "3) of\n"
      "the domain; zero where there is none.");
  module.def(
      "project_to_isosurface",
      [](const Field<3>& field, const DoubleArray& array, double isovalue) {
        return moved_points(array, [&](std::size_t, const Vec3& point) {
          return project_to_isosurface(field, point, isovalue);
        });
      },
      py::arg("field"), py::arg("points"), py::arg("isovalue"),
      "The points of the trilinear isosurface nearest along the gradient to world points (n, 3), "
      "within\n"
      "two voxels; points without one are returned as they are.");
  module.def(
      "project_along",
      [](const Field<3>& field, const DoubleArray& array, const DoubleArray& directions,
         double isovalue, double reach) {
        const std::vector<Vec3> outward = to_points<3>(directions);
        if (rows(array, 3, "points") != static_cast<py::ssize_t>(outward.size())) {
          throw Error("The directions must be an array of the shape of the points.");
        }
        return moved_points(array, [&](std::size_t i, const Vec3& point) {
          return project_along(field, point, outward[i], isovalue, reach);
        });
      },
      py::arg("field"), py::arg("points"), py::arg("outward"), py::arg("isovalue"),
      py::arg("reach"),
      "The points of the trilinear isosurface nearest to world points (n, 3), along the directions "
      "outward (n, 3)\n"
      "or against them, where values fall below the isovalue in that direction, within reach "
      "voxels; points\n"
      "without one are returned as they are.");
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
      "uint8 (n,): 1 where one of `directions` random rays from the isosurface's front leaves the\n"
      "domain, so that the world point can be seen from outside.");
  module.def(
      "connected_parts",
      [](const IndexArray& triangles, std::int32_t vertices) {
        rows(triangles, 3, "triangles");
        check_polygons(triangles, vertices);
        std::vector<std::int32_t> parts;
        {
          const py::gil_scoped_release unlocked;
          parts =
              connected_parts(triangles_of(triangles), static_cast<std::size_t>(triangles.shape(0)),
                              static_cast<std::size_t>(vertices));
        }
        return adopt<std::int32_t>(std::move(parts), {static_cast<py::ssize_t>(vertices)});
      },
      py::arg("triangles"), py::arg("vertices"),
      "The least vertex of the connected part that each of so many vertices is in, int32 (n,).");
  module.def(
      "large_parts",
      [](const FloatArray& vertices, const IndexArray& triangles, float smallest) {
        const auto count = static_cast<std::size_t>(rows(vertices, 3, "vertices"));
        rows(triangles, 3, "triangles");
        check_polygons(triangles, static_cast<std::int32_t>(count));
        LargeParts parts;
        {
          const py::gil_scoped_release unlocked;
          parts = large_parts(reinterpret_cast<const Vec<3, float>*>(vertices.data()), count,
                              triangles_of(triangles), static_cast<std::size_t>(triangles.shape(0)),
                              smallest);
        }
        const auto n = static_cast<py::ssize_t>(parts.vertices.size());
        const auto m = static_cast<py::ssize_t>(parts.triangles.size());
        return py::make_tuple(adopt<std::int32_t>(std::move(parts.vertices), {n}),
                              adopt<std::int32_t>(std::move(parts.triangles), {m, 3}));
      },
      py::arg("vertices"), py::arg("triangles"), py::arg("smallest"),
      "(vertices int32 (k,) that stay, triangles int32 (j, 3) by places among these) of a mesh\n"
      "without its connected parts that are shorter than `smallest` along all axes.");
  module.def(
      "polygon_edges",
      [](const IndexArray& polygons, std::int32_t vertices) {
        check_polygons(polygons, vertices);
        PolygonEdges edges;
        {
          const py::gil_scoped_release unlocked;
          edges = polygon_edges(polygons.data(), static_cast<std::size_t>(polygons.shape(0)),
                                static_cast<int>(polygons.shape(1)),
                                static_cast<std::size_t>(vertices));
        }
        const auto n = static_cast<py::ssize_t>(edges.vertices.size());
        return py::make_tuple(adopt<std::int32_t>(std::move(edges.vertices), {n, 2}),
                              adopt<std::int32_t>(std::move(edges.of_corner),
                                                  {polygons.shape(0), polygons.shape(1)}));
      },
      py::arg("polygons"), py::arg("vertices"),
      "(edges int32 (e, 2), each once, lower vertex first, ascending; the edge from each corner "
      "to\n"
      "the next one, int32 (m, k)) of polygons int32 (m, k) with so many vertices in all.");
}

}  // namespace leaflight::python
