// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings.h"
#include "leaflight/math/error.h"
#include "leaflight/math/progress.h"

namespace py = pybind11;
using namespace leaflight;

namespace {

// One bad_alloc for all: a sentence, not a traceback.
void translate(std::exception_ptr thrown, const py::object& error_type) {
  try {
    std::rethrow_exception(thrown);
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

  py::class_<Progress>(module, "Progress",
                       "Shared between a running bake and whoever watches it from another thread.")
      .def(py::init<>())
      .def_property_readonly("fraction", &Progress::fraction, "Work done, 0..1.")
      .def_property_readonly("stage", &Progress::stage, "What is being done, for the user.")
      .def_property_readonly("cancelled", &Progress::cancelled)
      .def("cancel", &Progress::cancel, "The bake raises Cancelled within half a second.")
      .def("stop", &Progress::stop,
           "A bake in rounds ends after the round under way, with what it has.")
      .def_property_readonly("stopped", &Progress::stopped);

  python::bind_field(module);
  python::bind_scene(module);
  python::bind_radiance_grid(module);
  python::bind_bake(module);
  python::bind_photons(module);
  python::bind_reference(module);
  python::bind_surface(module);
  python::bind_io(module);
  python::bind_settle(module);
  python::bind_self_check(module);
}
