// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "leaflight/io/dense_volume.h"

namespace leaflight {

// A scalar .nrrd, or a .nhdr with its data file in the same folder or below it, through Teem. World
// axes are right-anterior-superior, as in NIfTI. Throws Error; sizes are checked against the file
// before memory is allocated.
DenseVolume read_nrrd(const std::string& path);

}  // namespace leaflight
