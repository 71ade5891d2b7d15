// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "field/field.h"

namespace leaflight {

// The parts of the voxels at or above an isovalue that are connected across faces of voxels.
struct Components {
  std::vector<std::uint32_t> of_voxel;  // number of the part of each voxel; 0 is below the isovalue
  std::vector<std::uint64_t> sizes;     // voxels of each number, from 1 on in descending order
};

// Throws Cancelled, and Error for more than 2^32 - 1 voxels.
Components components(const Field<3>& field, float isovalue, Progress& progress);

}  // namespace leaflight
