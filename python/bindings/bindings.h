// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace leaflight::python {

void bind_field(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_direct_light(pybind11::module_& module);
void bind_radiance_grid(pybind11::module_& module);
void bind_walls(pybind11::module_& module);
void bind_bake(pybind11::module_& module);
void bind_photons(pybind11::module_& module);
void bind_rays(pybind11::module_& module);
void bind_reference(pybind11::module_& module);
void bind_surface(pybind11::module_& module);
void bind_io(pybind11::module_& module);
void bind_self_check(pybind11::module_& module);
void bind_workers(pybind11::module_& module);
void bind_memory(pybind11::module_& module);

}  // namespace leaflight::python
