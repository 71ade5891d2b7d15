// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"
#include "bindings.h"
#include "leaflight/io/exr.h"
#include "leaflight/io/nrrd.h"
#include "leaflight/io/vdb.h"

namespace leaflight::python {
namespace {

py::tuple to_python(DenseVolume&& volume) {
  return py::make_tuple(adopt<float>(std::move(volume.values), shape_zyx(volume.dims)),
                        from_affine(volume.index_to_world), volume.name);
}

}  // namespace

void bind_io(py::module_& module) {
  module.def(
      "write_bake",
      [](const std::string& path, const Field<3>& field, const RadianceGrid<3>& grid,
         const Metadata& metadata) {
        const py::gil_scoped_release unlocked;
        write_bake(path, field, grid, metadata);
      },
      py::arg("path"), py::arg("field"), py::arg("grid"), py::arg("metadata"),
      "Writes one .vdb under a temporary name and renames it.");
  module.def(
      "read_bake",
      [](const std::string& path) {
        StoredBake bake;
        {
          const py::gil_scoped_release unlocked;
          bake = read_bake(path);
        }
        return py::make_tuple(
            adopt<float>(std::move(bake.field.values), shape_zyx(bake.field.dims)),
            from_affine(bake.field.index_to_world),
            std::make_shared<RadianceGrid<3>>(std::move(bake.grid)), bake.metadata);
      },
      py::arg("path"), "(values [z, y, x], index_to_world, RadianceGrid, metadata) of a bake.");
  module.def(
      "read_vdb_volume",
      [](const std::string& path, const std::string& grid) {
        DenseVolume volume;
        {
          const py::gil_scoped_release unlocked;
          volume = read_vdb_volume(path, grid);
        }
        return to_python(std::move(volume));
      },
      py::arg("path"), py::arg("grid") = "",
      "(values float32 [z, y, x], index_to_world, name) of a scalar grid's active box.");
  module.def(
      "read_nrrd",
      [](const std::string& path) {
        DenseVolume volume;
        {
          const py::gil_scoped_release unlocked;
          volume = read_nrrd(path);
        }
        return to_python(std::move(volume));
      },
      py::arg("path"), "(values float32 [z, y, x], index_to_world, name).");
  module.def(
      "write_exr",
      [](const std::string& path,
         const py::array_t<float, py::array::c_style | py::array::forcecast>& pixels) {
        if (pixels.ndim() != 3) throw Error("An image must be an array [row, column, channel].");
        for (int a = 0; a < 2; ++a) {
          if (pixels.shape(a) > 65535) throw Error("An image may have 65535 pixels a side.");
        }
        write_exr(path, pixels.data(), static_cast<int>(pixels.shape(1)),
                  static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(2)));
      },
      py::arg("path"), py::arg("pixels"), "float32 [row, column, RGB or RGBA], top row first.");
  module.def(
      "read_exr",
      [](const std::string& path) {
        Image image = read_exr(path);
        return adopt<float>(std::move(image.pixels), {image.height, image.width, image.channels});
      },
      py::arg("path"), "float32 [row, column, RGB or RGBA], top row first.");
}

}  // namespace leaflight::python
