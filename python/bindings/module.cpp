// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "base/progress.h"
#include "bindings.h"

namespace py = pybind11;
using namespace leaflight;

namespace {

// Translates exceptions. A bad_alloc becomes a sentence. Messages may hold file names that are not
// UTF-8.
void translate(std::exception_ptr thrown, const py::object& error_type) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const std::string sentence = error.what();
    const auto text = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
        sentence.data(), static_cast<py::ssize_t>(sentence.size()), "surrogateescape"));
    PyErr_SetObject(error_type.ptr(), text.ptr());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(error_type.ptr(),
                    "There is not enough memory; choose a lower resolution or a smaller volume.");
  }
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "Leaflight's compiled core. Arrays are indexed [z, y, x]; points are (x, y, z).";
  static py::object error_type = py::register_exception<Error>(module, "LeaflightError");
  py::register_exception<Cancelled>(module, "Cancelled");
  py::register_exception_translator([](std::exception_ptr thrown) {
    if (thrown) translate(thrown, error_type);
  });

  py::class_<Progress>(
      module, "Progress",
      "The progress of work such as a bake or the reading of a file, shared with observers\n"
      "in other threads.")
      .def(py::init<>())
      .def("begin", &Progress::begin, py::arg("stage"), "Sets the name of the current stage.")
      .def("expect", &Progress::expect, py::arg("total"), "Sets the total work, in any unit.")
      .def("advance", &Progress::advance, py::arg("work"),
           "Adds finished work, in the unit of expect().")
      .def("check", &Progress::check, "Raises Cancelled after cancel().")
      .def_property_readonly("fraction", &Progress::fraction, "Finished share of the work, 0..1.")
      .def_property_readonly("stage", &Progress::stage, "Name of the current stage, for the user.")
      .def_property_readonly("cancelled", &Progress::cancelled)
      .def("cancel", &Progress::cancel, "Makes the bake raise Cancelled within half a second.")
      .def("stop", &Progress::stop,
           "Makes a bake in passes end after the current pass, with its light.")
      .def_property_readonly("stopped", &Progress::stopped);

  python::bind_field(module);
  python::bind_scene(module);
  python::bind_direct_light(module);
  python::bind_radiance_grid(module);
  python::bind_walls(module);
  python::bind_bake(module);
  python::bind_memory(module);
  python::bind_workers(module);
  python::bind_photons(module);
  python::bind_rays(module);
  python::bind_reference(module);
  python::bind_surface(module);
  python::bind_io(module);
  python::bind_self_check(module);
}
