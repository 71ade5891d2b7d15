// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/openvdb.h>

#include "field/field.h"

namespace leaflight {

// Returns the values of a field as a grid of floats, with masked voxels inactive. The grid stores
// only the topology. During writes it reads the values from the field, one block of 8^3 at a time,
// which saves four bytes per voxel. In the file its type must be that of FloatGrid. The field must
// outlive it.
openvdb::FloatGrid::Ptr field_grid(const Field<3>& field);

}  // namespace leaflight
