// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bake/driver/light_memory.h"
#include "bindings.h"
#include "math/large_array.h"
#include "math/platform.h"

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
             "What this process may take of the machine's memory at most, in bytes; 0: not known.");
  module.def(
      "limit_large_memory", &limit_large_memory, py::arg("limit"), py::arg("folder"),
      "Arrays of a volume that are made from now on lie in a file in the folder, which has no\n"
      "name, as soon as those in memory would take more than `limit` bytes; 0: no limit.");
  module.def(
      "large_memory",
      [] {
        const LargeMemory taken = large_memory();
        return py::make_tuple(taken.in_memory, taken.in_files);
      },
      "Bytes that the arrays of volumes take now: (in memory, in files).");
  module.def("large_array", &large_array, py::arg("shape"), py::arg("dtype"),
             "An array [z, y, x] for the values of a volume, whatever is in it; see "
             "limit_large_memory().\nRaises LeaflightError where the disk has no room.");
  using Released = py::call_guard<py::gil_scoped_release>;
  module.def(
      "light_memory", &light_memory, py::arg("scene"), py::arg("settings"), Released(),
      "About how many bytes a bake in passes takes at most, besides the arrays of the volume.");
  module.def("fitting_resolution", &fitting_resolution, py::arg("scene"), py::arg("settings"),
             py::arg("bytes"), Released(),
             "The finest texels (nx, ny, nz) for which light_memory() is at most `bytes`; zeros\n"
             "where it is with those that the bake takes by itself. Raises LeaflightError where\n"
             "none fit.");
}

}  // namespace leaflight::python
