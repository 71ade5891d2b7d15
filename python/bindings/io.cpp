// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "grid_object.h"
#include "io/bake_file.h"
#include "io/checkpoint_file.h"
#include "io/exr.h"
#include "io/replaced_files.h"
#include "io/seal.h"
#include "io/vdb_volume.h"

namespace leaflight::python {
namespace {

namespace fs = std::filesystem;

py::tuple to_python(DenseVolume&& volume) {
  return py::make_tuple(adopt(std::move(volume.values), array_shape(volume.dims)),
                        from_affine(volume.index_to_world), volume.name);
}

}  // namespace

void bind_io(py::module_& module) {
  py::class_<ReplacedFiles>(
      module, "ReplacedFiles",
      "Temporary files beside their targets, which replace all targets together.")
      .def(py::init<const std::vector<fs::path>&>(), py::arg("targets"), "Raises LeaflightError.")
      .def("temporary", &ReplacedFiles::temporary, py::arg("target"),
           "Returns the temporary path of a target, by its number.")
      .def("commit", &ReplacedFiles::commit, py::call_guard<py::gil_scoped_release>(),
           "Replaces all targets; returns when the files are on the disk. Raises LeaflightError.")
      .def("discard", &ReplacedFiles::discard, "Removes all files that were not committed.");
  module.def(
      "write_bake",
      [](const fs::path& path, const std::vector<std::shared_ptr<Field<3>>>& fields,
         const std::vector<std::shared_ptr<GridObject<3>>>& grids,
         const std::shared_ptr<WallRadiance<3>>& walls, const Metadata& metadata,
         const Progress* progress) {
        const py::gil_scoped_release unlocked;
        std::vector<const Field<3>*> field_pointers;
        for (const auto& field : fields) field_pointers.push_back(field.get());
        BakeParts baked;
        for (const auto& grid : grids) baked.grids.push_back(grid->baked.get());
        baked.walls = walls.get();
        write_bake(path, field_pointers, baked, metadata, progress);
      },
      py::arg("path"), py::arg("fields"), py::arg("grids"), py::arg("walls").none(true),
      py::arg("metadata"), py::arg("progress") = nullptr,
      "Writes a bake as a .vdb file, which it replaces atomically. Raises LeaflightError,\n"
      "and Cancelled with an unchanged file.");
  module.def(
      "read_bake",
      [](const fs::path& path, Progress* progress) {
        StoredBake bake;
        {
          const py::gil_scoped_release unlocked;
          bake = read_bake(path, progress);
        }
        py::list fields, grids;
        for (DenseVolume& field : bake.fields) {
          fields.append(py::make_tuple(adopt(std::move(field.values), array_shape(field.dims)),
                                       from_affine(field.index_to_world)));
        }
        for (RadianceGrid<3>& grid : bake.baked.grids) {
          grids.append(std::make_shared<GridObject<3>>(std::move(grid)));
        }
        std::shared_ptr<WallRadiance<3>> walls;
        if (!bake.baked.walls.empty()) {
          walls = std::make_shared<WallRadiance<3>>(std::move(bake.baked.walls));
        }
        return py::make_tuple(fields, grids, walls, bake.metadata);
      },
      py::arg("path"), py::arg("progress") = nullptr,
      "Reads a bake: ([(values [z, y, x], index_to_world), ...], [RadianceGrid, ...],\n"
      "WallRadiance or None, metadata). Grids with visibility maps need add_direct() before use,\n"
      "and walls attach_walls(). Raises LeaflightError, Cancelled.");
  module.def("has_seal", &has_seal, py::arg("path"),
             "True if a file ends with a checksum, which read_bake() checks. Raises\n"
             "LeaflightError.");
  module.def(
      "read_checkpoint", [](const fs::path& path) { return py::bytes(read_checkpoint(path)); },
      py::arg("path"),
      "Returns the text of a checkpoint of bake(), as bytes. Raises LeaflightError.");
  module.def("read_bake_header", &read_bake_header, py::arg("path"),
             "Reads only the metadata of a file, by key.");
  module.def(
      "attach_walls",
      [](WallRadiance<3>& walls, const Scene<3>& scene, Progress& progress) {
        const py::gil_scoped_release unlocked;
        attach(walls, scene, progress);
      },
      py::arg("walls"), py::arg("scene"), py::arg("progress"),
      "Adds the meshes of the scene and their direct light to a radiance from a file.\n"
      "Raises LeaflightError, Cancelled.");
  module.def(
      "read_vdb_volume",
      [](const fs::path& path, const std::string& grid) {
        DenseVolume volume;
        {
          const py::gil_scoped_release unlocked;
          volume = read_vdb_volume(path, grid);
        }
        return to_python(std::move(volume));
      },
      py::arg("path"), py::arg("grid") = "",
      "Returns (values float32 [z, y, x], index_to_world, name) of a scalar grid's active\n"
      "box.");
  module.def(
      "write_exr",
      [](const fs::path& path,
         const py::array_t<float, py::array::c_style | py::array::forcecast>& pixels,
         const std::string& comments) {
        if (pixels.ndim() != 3) throw Error("An image must be an array [row, column, channel].");
        for (int a = 0; a < 2; ++a) {
          if (pixels.shape(a) > 65535) throw Error("An image may have 65535 pixels a side.");
        }
        const float* const values = pixels.data();
        const auto height = static_cast<int>(pixels.shape(0));
        const auto width = static_cast<int>(pixels.shape(1));
        const auto channels = static_cast<int>(pixels.shape(2));
        const py::gil_scoped_release unlocked;
        write_exr(path, values, width, height, channels, comments);
      },
      py::arg("path"), py::arg("pixels"), py::arg("comments") = "",
      "float32 [row, column, RGB or RGBA], top row first.");
  module.def(
      "read_exr",
      [](const fs::path& path) {
        Image image;
        {
          const py::gil_scoped_release unlocked;
          image = read_exr(path);
        }
        return adopt<float>(std::move(image.pixels), {image.height, image.width, image.channels});
      },
      py::arg("path"), "float32 [row, column, RGB or RGBA], top row first.");
  module.def("read_exr_comments", &read_exr_comments, py::arg("path"),
             "Returns the comments of write_exr(); reads only the header.");
}

}  // namespace leaflight::python
