// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/affine.h"
#include "field/voxels.h"

namespace leaflight {

// A volume from a file, not yet validated as a field.
struct DenseVolume {
  Index<3> dims{};
  VoxelBuffer values;  // axis 0 fastest
  Affine<3> index_to_world;
  std::string name;
};

}  // namespace leaflight
