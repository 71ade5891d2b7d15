// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "io/dense_volume.h"

namespace leaflight {

// A scalar grid of any .vdb as a dense volume over its active voxels; the first one if no name is
// given. Throws Error.
DenseVolume read_vdb_volume(const std::filesystem::path& path, const std::string& grid_name);

}  // namespace leaflight
