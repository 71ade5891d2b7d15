// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "bake/plan/shared_parts.h"

namespace leaflight::python {

// Returns workers that call the methods of a Python object, from a thread without the interpreter's
// lock.
Workers workers_of(const pybind11::object& workers);

}  // namespace leaflight::python
