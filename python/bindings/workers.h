// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "bake/indirect/block_workers.h"

namespace leaflight::python {

// Returns workers that call the methods of a Python object, from a thread without the interpreter's
// lock.
BlockWorkers workers_of(const pybind11::object& workers);

}  // namespace leaflight::python
