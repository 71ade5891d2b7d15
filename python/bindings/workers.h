// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "bake/indirect/block_workers.h"

namespace leaflight::python {

// Calls the methods of a Python object, from a thread that does not hold the interpreter.
BlockWorkers workers_of(const pybind11::object& workers);

}  // namespace leaflight::python
