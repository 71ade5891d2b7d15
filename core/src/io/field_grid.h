// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/openvdb.h>

#include "field/field.h"

namespace leaflight {

// The values of a field as a grid of floats, masked voxels inactive. It holds which voxels there
// are; their values, which would take four bytes each, are read from the field as they are written,
// a block of 8^3 at a time. In the file its type must be that of FloatGrid. The field must outlive
// it.
openvdb::FloatGrid::Ptr field_grid(const Field<3>& field);

}  // namespace leaflight
