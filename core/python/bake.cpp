// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/bake.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "arrays.h"
#include "bindings.h"
#include "leaflight/surface/atlas.h"
#include "leaflight/transport/reference.h"

namespace leaflight::python {
namespace {

const char* name_of(EstimatorName name) {
  switch (name) {
    case EstimatorName::volumetric:
      return "volumetric";
    case EstimatorName::path:
      return "path";
    default:
      return "gather";
  }
}

py::dict statistics(const RadianceGrid<3>& grid) {
  py::list skipped;
  for (const SkippedPass& pass : grid.statistics.skipped) {
    skipped.append(std::vector<std::string>{pass.pass, pass.reason});
  }
  py::dict result;
  result["seconds"] = grid.statistics.seconds;
  result["rays"] = grid.statistics.rays;
  result["texels"] = grid.lattice.active.size();
  result["peak_memory_bytes"] = grid.statistics.peak_memory_bytes;
  result["skipped_passes"] = skipped;
  return result;
}

template <class Value>
py::array_t<float> spread(const TexelLattice<3>& lattice, const std::vector<Value>& values,
                          std::vector<py::ssize_t> shape) {
  std::vector<Value> dense(lattice.texels(), Value(0));
  for (std::size_t s = 0; s < values.size(); ++s) dense[lattice.active[s]] = values[s];
  return adopt<float>(std::move(dense), std::move(shape));
}

py::array_t<float> dense(const RadianceGrid<3>& grid, const std::string& name) {
  std::vector<py::ssize_t> shape = shape_zyx(grid.lattice.resolution);
  if (name == "radiance_error") return spread(grid.lattice, grid.radiance_error, shape);
  shape.push_back(3);
  if (name == "radiance") return spread(grid.lattice, grid.radiance, shape);
  if (name == "radiance_indirect") return spread(grid.lattice, grid.radiance_indirect, shape);
  throw Error("A bake has no grid '" + name +
              "'; choose radiance, radiance_indirect or radiance_error.");
}

py::array_t<std::uint8_t> mask(const RadianceGrid<3>& grid) {
  std::vector<std::uint8_t> active(grid.lattice.texels(), 0);
  for (const std::uint32_t texel : grid.lattice.active) active[texel] = 1;
  return adopt<std::uint8_t>(std::move(active), shape_zyx(grid.lattice.resolution));
}

py::array_t<float> lookup_at(const RadianceGrid<3>& grid, const Field<3>& field,
                             const DoubleArray& array) {
  const std::vector<Vec3> points = to_points(array);
  std::vector<Vec<3, float>> radiance(points.size());
  {
    const py::gil_scoped_release unlocked;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      radiance[i] = lookup(grid, field.world_to_index.point(points[i]));
    });
  }
  return adopt<float>(std::move(radiance), {static_cast<py::ssize_t>(points.size()), 3});
}

py::tuple atlas(const RadianceGrid<3>& grid) {
  Atlas result;
  {
    const py::gil_scoped_release unlocked;
    result = make_atlas(grid);
  }
  const int columns = result.columns, rows = result.rows;
  return py::make_tuple(adopt<float>(std::move(result.pixels), {result.height, result.width, 4}),
                        columns, rows);
}

py::tuple reference(const Scene<3>& scene, const DoubleArray& array, double isovalue, int samples,
                    std::uint64_t seed, int threads, Progress* progress) {
  const std::vector<Vec3> points = to_points(array);
  if (samples < 1) throw Error("The reference needs at least one sample per point.");
  Progress own;
  std::vector<Vec<3, float>> radiance, error;
  {
    const py::gil_scoped_release unlocked;
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    const auto result = arena.execute([&] {
      return reference_radiance(scene, points, isovalue, samples, seed, progress ? *progress : own);
    });
    for (const ReferenceRadiance& r : result) {
      radiance.emplace_back(r.radiance);
      error.emplace_back(r.standard_error);
    }
  }
  const auto n = static_cast<py::ssize_t>(points.size());
  return py::make_tuple(adopt<float>(std::move(radiance), {n, 3}),
                        adopt<float>(std::move(error), {n, 3}));
}

}  // namespace

void bind_bake(py::module_& module) {
  py::class_<BakeSettings<3>>(module, "BakeSettings")
      .def(py::init<>())
      .def_readwrite("resolution", &BakeSettings<3>::resolution,
                     "Texels along x, y, z; (0, 0, 0) for one per voxel.")
      .def_readwrite("samples", &BakeSettings<3>::samples,
                     "Samples per texel, each one shadow ray and one gather ray.")
      .def_readwrite("photons", &BakeSettings<3>::photons, "Photons emitted over all isovalues.")
      .def_property(
          "estimator", [](const BakeSettings<3>& s) { return name_of(s.estimator); },
          [](BakeSettings<3>& s, const std::string& name) { s.estimator = estimator_from(name); },
          "gather, volumetric or path.")
      .def_readwrite("seed", &BakeSettings<3>::seed)
      .def_readwrite("threads", &BakeSettings<3>::threads, "0: all.");

  py::class_<RadianceGrid<3>, std::shared_ptr<RadianceGrid<3>>>(
      module, "RadianceGrid", "The outer side's radiance [W/(m^2 sr)] of every leaf of a window.")
      .def_property_readonly("resolution",
                             [](const RadianceGrid<3>& g) { return g.lattice.resolution; })
      .def_property_readonly("texels",
                             [](const RadianceGrid<3>& g) { return g.lattice.active.size(); })
      .def_property_readonly("statistics", &statistics)
      .def("dense", &dense, py::arg("name"),
           "radiance or radiance_indirect: float32 [z, y, x, 3]; radiance_error, the standard "
           "error\n"
           "of the mean over the channels: float32 [z, y, x]. Zero at inactive texels.")
      .def("mask", &mask, "uint8 [z, y, x], 1 at active texels.")
      .def("lookup", &lookup_at, py::arg("field"), py::arg("points"),
           "Trilinear radiance (n, 3) at world points (n, 3), over active texels only.")
      .def("atlas", &atlas,
           "(pixels float32 [row, column, RGBA] bottom row first, columns, rows): slice k of the\n"
           "texture is the tile in column k % columns and row k // columns, without padding.");

  module.def(
      "bake",
      [](const Scene<3>& scene, const BakeSettings<3>& settings, Progress& progress) {
        const py::gil_scoped_release unlocked;
        return std::make_shared<RadianceGrid<3>>(bake(scene, settings, progress));
      },
      py::arg("scene"), py::arg("settings"), py::arg("progress"),
      "Lights all leaves of the scene's window. Raises LeaflightError, or Cancelled.");
  module.def("reference", &reference, py::arg("scene"), py::arg("points"), py::arg("isovalue"),
             py::arg("spp"), py::arg("seed") = 0, py::arg("threads") = 0,
             py::arg("progress") = nullptr,
             "Unbiased radiance of the leaf's outer side by path tracing at world points (n, 3):\n"
             "(radiance (n, 3), standard error (n, 3)).");
}

}  // namespace leaflight::python
