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
             "About how many bytes a BlockTracer holds at most, the volume's values included.");
  py::class_<BlockTracer>(
      module, "BlockTracer",
      "Traces single blocks of indirect light for a bake in passes of the same scene "
      "and settings that runs\n"
      "elsewhere: what bake()'s `workers` give it.")
      .def(py::init<const Scene<3>&, const BakeSettings<3>&, Progress&>(), py::arg("scene"),
           py::arg("settings"), py::arg("progress"), py::keep_alive<1, 2>(), py::keep_alive<1, 4>(),
           Released(),
           "progress.cancel() ends whatever is done with Cancelled. Raises LeaflightError where\n"
           "such a bake has no passes.")
      .def(
          "look_up",
          [](BlockTracer& tracer, const std::string& state) {
            std::istringstream stream(state);
            stream.exceptions(std::ios::failbit | std::ios::badbit);
            tracer.look_up(stream);
          },
          py::arg("state"), Released(),
          "Takes the bytes that workers.begin() was given; blocks need them.")
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
          py::arg("number"), "The block of this number: bytes for workers.take().");
}

}  // namespace leaflight::python
