// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "io/dense_volume.h"

namespace leaflight {

// Reads a scalar grid of a .vdb file as a dense volume over its active voxels. An empty name means
// the first grid. Throws Error.
DenseVolume read_vdb_volume(const std::filesystem::path& path, const std::string& grid_name);

}  // namespace leaflight
