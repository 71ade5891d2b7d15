// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "field/shading_gradient.h"
#include "mesh_arrays.h"
#include "surface/islands.h"
#include "surface/marching_squares.h"
#include "surface/polygon_edges.h"
#include "surface/project.h"
#include "transport/seen_from_outside.h"

namespace leaflight::python {
namespace {

using IndexArray = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;
// An array of the caller that is filled, so it must not be converted.
using OutIndices = py::array_t<std::int32_t, 0>;

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
      "Returns (vertices float32 (n, 3) world, outward unit normals (n, 3), triangles int32\n"
      "(m, 3)) by marching cubes, a manifold. Without normals, which take most of the time,\n"
      "they are None.");
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
      "Returns (vertices (n, 2) world, outward unit normals (n, 2), segments (m, 2)) by\n"
      "marching squares.");
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
      "Returns outward unit shading normals float32 (n, 3) of the isosurfaces through world\n"
      "points (n, 3) of the domain; zero if there is none.");
  module.def(
      "project_to_isosurface",
      [](const Field<3>& field, const DoubleArray& array, double isovalue) {
        return moved_points(array, [&](std::size_t, const Vec3& point) {
          return project_to_isosurface(field, point, isovalue);
        });
      },
      py::arg("field"), py::arg("points"), py::arg("isovalue"),
      "Moves world points (n, 3) to the nearest point of the isosurface along the gradient,\n"
      "within two voxels. Points without such a point are unchanged.");
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
      "Moves world points (n, 3) to the nearest point of the isosurface along the\n"
      "directions outward (n, 3) or against them, within reach voxels. Values must fall\n"
      "below the isovalue in that direction. Points without such a point are unchanged.");
  module.def(
      "seen_from_outside",
      [](const Field<3>& field, const DoubleArray& array, double isovalue, int directions,
         std::uint64_t seed) {
        const std::vector<Vec3> points = to_points<3>(array);
        std::vector<std::uint8_t> result;
        {
          const py::gil_scoped_release unlocked;
          result = seen_from_outside(field, points, isovalue, directions, seed);
        }
        const auto n = static_cast<py::ssize_t>(result.size());
        return adopt<std::uint8_t>(std::move(result), {n});
      },
      py::arg("field"), py::arg("points"), py::arg("isovalue"), py::arg("directions") = 32,
      py::arg("seed") = 0,
      "Returns uint8 (n,): 1 if a world point on the isosurface is visible from outside,\n"
      "because one of `directions` random rays from its front leaves the domain without a\n"
      "hit.");
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
      "Returns, for each vertex, the least vertex of its connected part, int32 (n,).");
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
      "Removes connected parts of a mesh that are shorter than `smallest` along all axes.\n"
      "Returns (numbers of the remaining vertices int32 (k,), triangles int32 (j, 3) by\n"
      "indices into these).");
  py::class_<PolygonEdges>(module, "PolygonEdges", "The unique edges of a mesh's polygons.")
      .def(py::init([](const IndexArray& polygons, std::int32_t vertices) {
             check_polygons(polygons, vertices);
             const py::gil_scoped_release unlocked;
             return PolygonEdges(polygons.data(), static_cast<std::size_t>(polygons.shape(0)),
                                 static_cast<int>(polygons.shape(1)),
                                 static_cast<std::size_t>(vertices));
           }),
           py::arg("polygons"), py::arg("vertices"),
           "polygons: int32 (m, k), each vertex in [0, vertices).")
      .def("__len__", &PolygonEdges::count)
      .def(
          "write",
          [](const PolygonEdges& edges, OutIndices edge_array, OutIndices corner_array) {
            auto vertices = edge_array.mutable_unchecked<2>();
            auto corners = corner_array.mutable_unchecked<1>();
            if (vertices.shape(0) != static_cast<py::ssize_t>(edges.count()) ||
                vertices.shape(1) != 2 ||
                corners.shape(0) != static_cast<py::ssize_t>(edges.corners())) {
              throw Error("The arrays for the edges do not have their number.");
            }
            const py::gil_scoped_release unlocked;
            edges.visit(
                [&](std::int32_t edge, std::int32_t lower, std::int32_t other) {
                  vertices(edge, 0) = lower;
                  vertices(edge, 1) = other;
                },
                [&](std::int32_t corner, std::int32_t edge) { corners(corner) = edge; });
          },
          py::arg("edges").noconvert(), py::arg("corners").noconvert(),
          "Fills int32 arrays with any strides: the vertices of each edge (e, 2), lower vertex\n"
          "first, ascending, and the edge from each corner to the next one (m * k,).");
}

}  // namespace leaflight::python
