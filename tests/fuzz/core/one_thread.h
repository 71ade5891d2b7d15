// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/global_control.h>

namespace leaflight::fuzz {

// A try is a matter of microseconds, and the same again.
struct OneThread {
  tbb::global_control control{tbb::global_control::max_allowed_parallelism, 1};
};

}  // namespace leaflight::fuzz
