// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/settle.h"

#include <tbb/task_arena.h>

#include "arrays.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

template <class Row, class Array>
std::vector<Row> rows_of(const Array& array, const char* what) {
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw Error(std::string("The ") + what + " must be an array of shape (n, 3).");
  }
  const auto view = array.template unchecked<2>();
  std::vector<Row> rows(array.shape(0));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int a = 0; a < 3; ++a) rows[i][a] = view(static_cast<py::ssize_t>(i), a);
  }
  return rows;
}

IsosurfaceMesh mesh_of(const Floats& vertices, const Floats& normals, const Integers& triangles) {
  IsosurfaceMesh mesh{rows_of<Vec<3, float>>(vertices, "vertices"),
                      rows_of<Vec<3, float>>(normals, "normals"),
                      rows_of<std::array<std::int32_t, 3>>(triangles, "triangles")};
  for (const auto& vertex : mesh.vertices) check_point(vertex);
  for (const auto& normal : mesh.normals) check_point(normal);
  if (mesh.normals.size() != mesh.vertices.size()) {
    throw Error("There must be one normal for each vertex.");
  }
  const auto last = static_cast<std::int64_t>(mesh.vertices.size()) - 1;
  for (const auto& triangle : mesh.triangles) {
    for (const std::int32_t v : triangle) {
      if (v < 0 || v > last) {
        throw Error("A triangle has the corner " + std::to_string(v) +
                    ": there are the vertices 0.." + std::to_string(last) + ".");
      }
    }
  }
  return mesh;
}

}  // namespace

void bind_settle(py::module_& module) {
  py::class_<Settle>(
      module, "Settle",
      "The light of one leaf where the isovalue rests, at the vertices of its mesh:\n"
      "direct light traced there, indirect light of the bake corrected by paths.")
      .def(py::init([](const Scene<3>& scene, const RadianceGrid<3>& grid, const Floats& vertices,
                       const Floats& normals, const Integers& triangles, double c, int volume,
                       bool back, double tolerance, std::uint64_t seed) {
             IsosurfaceMesh mesh = mesh_of(vertices, normals, triangles);
             const py::gil_scoped_release unlocked;
             return std::make_unique<Settle>(scene, grid, std::move(mesh),
                                             SettleSettings{volume, c, back, tolerance, seed});
           }),
           py::arg("scene"), py::arg("grid"), py::arg("vertices"), py::arg("normals"),
           py::arg("triangles"), py::arg("c"), py::arg("volume") = 0, py::arg("back") = false,
           py::arg("tolerance") = SettleSettings{}.tolerance, py::arg("seed") = 0,
           py::keep_alive<1, 2>(), py::keep_alive<1, 3>(),
           "What contour() returns for the leaf: vertices float32 (n, 3) world, outward normals\n"
           "(n, 3), triangles int32 (m, 3). grid: of the volume. tolerance: the standard error of\n"
           "direct radiance at which a vertex is left alone. Raises LeaflightError.")
      .def_property_readonly("rounds", &Settle::rounds, "Rounds until nothing is left to do.")
      .def_property_readonly("rounds_done", &Settle::rounds_done)
      .def_property_readonly("rays", &Settle::rays, "Rays traced.")
      .def(
          "refine",
          [](Settle& settle, Progress& progress, int threads) {
            const py::gil_scoped_release unlocked;
            tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
            arena.execute([&] { settle.refine(progress); });
          },
          py::arg("progress"), py::arg("threads") = 0,
          "One round more. Raises Cancelled within half a second; what was found is kept.")
      .def(
          "settled",
          [](const Settle& settle) {
            Settle::Settled found;
            {
              const py::gil_scoped_release unlocked;
              found = settle.settled();
            }
            const auto n = static_cast<py::ssize_t>(found.error.size());
            return py::make_tuple(adopt<float>(std::move(found.radiance), {n, 3}),
                                  adopt<float>(std::move(found.error), {n}));
          },
          "Of the vertices: (radiance float32 (n, 3) [W/(m^2 sr)], its standard error, of the "
          "mean\n"
          "over the channels, float32 (n,)).");
}

}  // namespace leaflight::python
