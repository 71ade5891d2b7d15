// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "trace/isosurface_ray.h"
#include "trace/mesh_bvh.h"

namespace leaflight::python {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Rays {
  std::vector<Vec3> origins, directions;
};

Rays to_rays(const DoubleArray& origins, const DoubleArray& directions) {
  Rays rays{to_points<3>(origins), to_points<3>(directions)};
  if (rays.origins.size() != rays.directions.size()) {
    throw Error("There must be one direction for each origin.");
  }
  return rays;
}

py::tuple isosurface_hits(const Field<3>& field, const DoubleArray& origins,
                          const DoubleArray& directions, double isovalue) {
  const Rays rays = to_rays(origins, directions);
  const std::size_t n = rays.origins.size();
  std::vector<double> distance(n, infinity);
  std::vector<std::uint8_t> from_above(n, 0);
  {
    const py::gil_scoped_release unlocked;
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      IsosurfaceRay<3> ray;
      ray.position = field.world_to_index.point(rays.origins[i]);
      ray.direction = field.world_to_index.vector(rays.directions[i]);
      ray.isovalue = isovalue;
      if (const auto hit = intersect(field, ray)) {
        distance[i] = hit->t;
        from_above[i] = hit->from_above;
      }
    });
  }
  const auto count = static_cast<py::ssize_t>(n);
  return py::make_tuple(adopt<double>(std::move(distance), {count}),
                        adopt<std::uint8_t>(std::move(from_above), {count}));
}

py::tuple mesh_hits(const Mesh<3>& mesh, const DoubleArray& origins,
                    const DoubleArray& directions) {
  const Rays rays = to_rays(origins, directions);
  const std::size_t n = rays.origins.size();
  std::vector<double> distance(n, infinity);
  std::vector<std::int32_t> facets(n, -1);
  std::vector<std::array<double, 2>> coordinates(n, {0, 0});
  {
    const py::gil_scoped_release unlocked;
    const MeshBvh<3> bvh({mesh});
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      if (const auto hit = bvh.intersect(rays.origins[i], rays.directions[i], infinity)) {
        distance[i] = hit->t;
        facets[i] = hit->facet;
        coordinates[i] = {hit->u, hit->v};
      }
    });
  }
  const auto count = static_cast<py::ssize_t>(n);
  return py::make_tuple(adopt<double>(std::move(distance), {count}),
                        adopt<std::int32_t>(std::move(facets), {count}),
                        adopt<double>(std::move(coordinates), {count, 2}));
}

}  // namespace

void bind_rays(py::module_& module) {
  module.def("isosurface_hits", &isosurface_hits, py::arg("field"), py::arg("origins"),
             py::arg("directions"), py::arg("isovalue"),
             "Intersects rays from world points (n, 3), in directions (n, 3) of any length, with\n"
             "the isosurface of an isovalue in data units. Returns (distances float64 (n,) in\n"
             "lengths of the direction, infinite without a hit; uint8 (n,), 1 if the ray hits the\n"
             "back).");
  module.def("mesh_hits", &mesh_hits, py::arg("mesh"), py::arg("origins"), py::arg("directions"),
             "Intersects such rays with a Mesh, in single precision. Returns (distances float64\n"
             "(n,), triangles int32 (n,) or -1, barycentric coordinates (n, 2) of the triangle's\n"
             "second and third vertex).");
}

}  // namespace leaflight::python
