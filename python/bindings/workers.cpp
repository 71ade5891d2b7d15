// SPDX-License-Identifier: GPL-3.0-or-later
#include "workers.h"

#include <sstream>

#include "bake/driver/part_tracer.h"
#include "bindings.h"

namespace py = pybind11;

namespace leaflight::python {
Workers workers_of(const py::object& workers) {
  Workers calls;
  calls.send = [&workers](PartData kind, const Workers::Write& write) {
    std::ostringstream stream;
    write(stream);
    const std::string data = std::move(stream).str();
    const py::gil_scoped_acquire locked;
    workers.attr("send")(static_cast<int>(kind), py::bytes(data));
  };
  calls.announce = [&workers](const std::vector<BakePart>& parts) {
    const py::gil_scoped_acquire locked;
    py::list all;
    for (const BakePart& part : parts) {
      all.append(py::bytes(reinterpret_cast<const char*>(&part), sizeof part));
    }
    return workers.attr("announce")(all).cast<int>();
  };
  calls.take = [&workers](int number) {
    const py::gil_scoped_acquire locked;
    return workers.attr("take")(number).cast<std::string>();
  };
  calls.drop = [&workers](int first, int count) {
    const py::gil_scoped_acquire locked;
    try {
      workers.attr("drop")(first, count);
    } catch (py::error_already_set& error) {
      error.discard_as_unraisable("drop");
    }
  };
  return calls;
}

void bind_workers(py::module_& module) {
  using Released = py::call_guard<py::gil_scoped_release>;
  module.def(
      "part_tracer_memory", &part_tracer_memory, py::arg("scene"), py::arg("settings"), Released(),
      "Estimates the maximum memory of a PartTracer in bytes, including the volume's values.");
  py::class_<PartTracer>(
      module, "PartTracer",
      "Computes parts of a bake in passes in another process, as a worker of bake(). Scene and\n"
      "settings must be equal.")
      .def(py::init<const Scene<3>&, const BakeSettings<3>&, Progress&>(), py::arg("scene"),
           py::arg("settings"), py::arg("progress"), py::keep_alive<1, 2>(), py::keep_alive<1, 4>(),
           Released(),
           "progress.cancel() makes every call raise Cancelled. Raises LeaflightError if such a\n"
           "bake has no passes.")
      .def(
          "read",
          [](PartTracer& tracer, int kind, const py::bytes& data) {
            std::istringstream stream{std::string(data)};
            stream.exceptions(std::ios::failbit | std::ios::badbit);
            const py::gil_scoped_release unlocked;
            tracer.read(static_cast<PartData>(kind), stream);
          },
          py::arg("kind"), py::arg("data"), "Reads what workers.send() received and parts look up.")
      .def(
          "traced",
          [](PartTracer& tracer, const py::bytes& bytes) {
            BakePart part;
            copy_items(std::string(bytes), &part, 1);
            std::string found;
            {
              const py::gil_scoped_release unlocked;
              found = tracer.traced(part);
            }
            return py::bytes(found);
          },
          py::arg("part"),
          "Computes a part that workers.announce() received; returns bytes for workers.take().");
}

}  // namespace leaflight::python
