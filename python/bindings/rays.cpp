// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "trace/isosurface_ray.h"
#include "trace/walls.h"

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
    const Walls<3> walls({mesh});
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      if (const auto hit = walls.intersect(rays.origins[i], rays.directions[i], infinity)) {
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
  module.def(
      "isosurface_hits", &isosurface_hits, py::arg("field"), py::arg("origins"),
      py::arg("directions"), py::arg("isovalue"),
      "Where rays first hit the isosurface of an isovalue (in data units), from world points\n"
      "(n, 3) in directions (n, 3) of any length: (distances float64 (n,), in lengths of\n"
      "the direction, infinite where they do not; uint8 (n,), 1 where the ray arrives from\n"
      "higher values, at the back).");
  module.def("mesh_hits", &mesh_hits, py::arg("mesh"), py::arg("origins"), py::arg("directions"),
             "Where such rays first hit a Mesh, in single precision: (distances float64 (n,);\n"
             "triangles int32 (n,), -1 for none; barycentric coordinates (n, 2) of its second and\n"
             "third vertex).");
}

}  // namespace leaflight::python
