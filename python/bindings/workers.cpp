// SPDX-License-Identifier: GPL-3.0-or-later
#include "workers.h"

#include <sstream>

#include "bake/driver/block_tracer.h"
#include "bindings.h"

namespace py = pybind11;

namespace leaflight::python {
BlockWorkers workers_of(const py::object& workers) {
  BlockWorkers calls;
  calls.begin = [&workers](int first, int count,
                           const std::function<void(std::ostream&)>& looked_up) {
    std::ostringstream stream;
    looked_up(stream);
    const py::gil_scoped_acquire locked;
    workers.attr("begin")(first, count, py::bytes(stream.str()));
  };
  calls.take = [&workers](int number) {
    const py::gil_scoped_acquire locked;
    return workers.attr("take")(number).cast<std::string>();
  };
  return calls;
}

void bind_workers(py::module_& module) {
  using Released = py::call_guard<py::gil_scoped_release>;
  module.def("block_tracer_memory", &block_tracer_memory, py::arg("scene"), py::arg("settings"),
             Released(),
             "Estimates the maximum memory of a BlockTracer in bytes, including the volume's\n"
             "values.");
  py::class_<BlockTracer>(
      module, "BlockTracer",
      "Traces single blocks of indirect light for a bake in passes in another process, as a\n"
      "worker of bake(). Scene and settings must be equal.")
      .def(py::init<const Scene<3>&, const BakeSettings<3>&, Progress&>(), py::arg("scene"),
           py::arg("settings"), py::arg("progress"), py::keep_alive<1, 2>(), py::keep_alive<1, 4>(),
           Released(),
           "progress.cancel() makes every call raise Cancelled. Raises LeaflightError if such a\n"
           "bake has no passes.")
      .def(
          "look_up",
          [](BlockTracer& tracer, const std::string& state) {
            std::istringstream stream(state);
            stream.exceptions(std::ios::failbit | std::ios::badbit);
            tracer.look_up(stream);
          },
          py::arg("state"), Released(),
          "Reads the bytes that workers.begin() received, which blocks need.")
      .def(
          "trace",
          [](BlockTracer& tracer, int number) {
            std::string block;
            {
              const py::gil_scoped_release unlocked;
              block = tracer.trace(number);
            }
            return py::bytes(block);
          },
          py::arg("number"), "Traces the block of this number; returns bytes for workers.take().");
}

}  // namespace leaflight::python
