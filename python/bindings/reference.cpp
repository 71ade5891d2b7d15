// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/reference.h"

#include <tbb/task_arena.h>

#include "arrays.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

py::tuple arrays_of(const std::vector<ReferenceRadiance>& result) {
  std::vector<Vec<3, float>> radiance, error;
  for (const ReferenceRadiance& r : result) {
    radiance.emplace_back(r.radiance);
    error.emplace_back(r.standard_error);
  }
  const auto n = static_cast<py::ssize_t>(result.size());
  return py::make_tuple(adopt<float>(std::move(radiance), {n, 3}),
                        adopt<float>(std::move(error), {n, 3}));
}

template <int D, class Points>
py::tuple trace_reference(const Scene<D>& scene, const Points& points,
                          const ReferenceSettings& settings, int threads, Progress* progress) {
  if (settings.samples < 1) throw Error("The reference needs at least one sample per point.");
  Progress unwatched;
  std::vector<ReferenceRadiance> result;
  {
    const py::gil_scoped_release unlocked;
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    result = arena.execute([&] {
      return reference_radiance(scene, points, settings, progress ? *progress : unwatched);
    });
  }
  return arrays_of(result);
}

template <int D>
py::tuple reference(const Scene<D>& scene, const DoubleArray& points, double c, int samples,
                    std::uint64_t seed, int threads, Progress* progress, int volume, bool back) {
  return trace_reference(scene, to_points<D>(points), {c, samples, seed, volume, back}, threads,
                         progress);
}

// Traces points of a mesh: facets (n,), and barycentric coordinates (n, 2) of the second and third
// vertex.
template <int D>
py::tuple reference_walls(const Scene<D>& scene, int mesh, const std::vector<int>& facets,
                          const DoubleArray& coordinates, double c, int samples, std::uint64_t seed,
                          int threads, Progress* progress, bool back) {
  if (rows(coordinates, 2, "coordinates") != static_cast<py::ssize_t>(facets.size())) {
    throw Error("There must be one row of coordinates for each facet.");
  }
  std::vector<FacetPoint> points;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    check_point(Vec<2>(coordinates.at(row, 0), coordinates.at(row, 1)));
    points.push_back({mesh, facets[i], coordinates.at(row, 0), coordinates.at(row, 1), !back});
  }
  return trace_reference(scene, points, {c, samples, seed, 0, false}, threads, progress);
}

template <int D>
void bind_reference_functions(py::module_& module, const std::string& suffix) {
  module.def(("reference" + suffix).c_str(), &reference<D>, py::arg("scene"), py::arg("points"),
             py::arg("c"), py::arg("spp"), py::arg("seed") = 0, py::arg("threads") = 0,
             py::arg("progress") = nullptr, py::arg("volume") = 0, py::arg("back") = false,
             "Traces paths from a volume's isosurface at world points (n, D). Returns (radiance\n"
             "(n, 3), standard error (n, 3)). It is unbiased, except for caustics of lights\n"
             "without extent, which no path hits.");
  module.def(("reference_walls" + suffix).c_str(), &reference_walls<D>, py::arg("scene"),
             py::arg("mesh"), py::arg("facets"), py::arg("coordinates"), py::arg("c"),
             py::arg("spp"), py::arg("seed") = 0, py::arg("threads") = 0,
             py::arg("progress") = nullptr, py::arg("back") = false,
             "Does the same at points of a wall: facets (n,) and barycentric coordinates (n, 2),\n"
             "seen from the side of the normals or from behind.");
}

}  // namespace

void bind_reference(py::module_& module) {
  bind_reference_functions<3>(module, "");
  bind_reference_functions<2>(module, "2");
}

}  // namespace leaflight::python
