// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bake/driver/light_memory.h"
#include "base/large_array.h"
#include "base/platform.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

py::array large_array(const std::vector<py::ssize_t>& shape, const py::dtype& type) {
  std::size_t bytes = static_cast<std::size_t>(type.itemsize());
  for (const py::ssize_t n : shape) bytes *= static_cast<std::size_t>(n);
  struct Owner {
    void* memory;
    std::size_t bytes;
    ~Owner() { free_large(memory, bytes); }
  };
  auto owner = std::unique_ptr<Owner>(new Owner{allocate_large(bytes), bytes});
  const void* const first = owner->memory;
  const py::capsule archive(owner.get(), [](void* p) { delete static_cast<Owner*>(p); });
  owner.release();
  return py::array(type, shape, first, archive);
}

}  // namespace

void bind_memory(py::module_& module) {
  module.def("machine_memory", &machine_memory,
             "Returns the memory that this process may use, in bytes; 0: unknown.");
  module.def("limit_large_memory", &limit_large_memory, py::arg("limit"), py::arg("folder"),
             "Limits the bytes of volumes' arrays in memory. Arrays above the limit are mapped to\n"
             "a nameless file in the folder. 0: no limit.");
  module.def(
      "large_memory",
      [] {
        const LargeMemory taken = large_memory();
        return py::make_tuple(taken.in_memory, taken.in_files);
      },
      "Returns the current bytes of the arrays of volumes: (in memory, in files).");
  module.def("large_array", &large_array, py::arg("shape"), py::arg("dtype"),
             "Returns an uninitialized array [z, y, x] for the values of a volume; see\n"
             "limit_large_memory(). Raises LeaflightError if the disk is full.");
  using Released = py::call_guard<py::gil_scoped_release>;
  module.def(
      "light_memory", &light_memory, py::arg("scene"), py::arg("settings"), Released(),
      "Estimates the maximum memory of a bake in passes in bytes, without the arrays of the\n"
      "volume.");
  module.def("fitting_resolution", &fitting_resolution, py::arg("scene"), py::arg("settings"),
             py::arg("bytes"), Released(),
             "Returns the finest resolution (nx, ny, nz) whose light_memory() is at most `bytes`,\n"
             "or zeros if the default resolution fits. Raises LeaflightError if none fits.");
}

}  // namespace leaflight::python
