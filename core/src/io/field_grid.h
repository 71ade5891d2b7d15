// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/openvdb.h>

#include "field/field.h"
#include "io/vdb_file.h"

namespace leaflight {

// Returns the values of a field as a grid of floats, with masked voxels inactive. The grid stores
// only the topology. During writes it reads the values from the field, one block of 8^3 at a time,
// which saves four bytes per voxel. In the file its type must be that of FloatGrid. The field must
// outlive it.
openvdb::FloatGrid::Ptr field_grid(const Field<3>& field);

// Leaf nodes of a run. The runs of a file are compressed and decompressed in parallel.
constexpr std::size_t run_of_leaves = 512;

// Returns the positions in the stream of the runs of a field_grid() that was written, and their
// end.
const std::vector<std::uint64_t>& runs_of(const openvdb::FloatGrid& field_grid);

// Reads the voxels of a field_grid() in parallel. Values of integers must be integers of the type
// with this number in Voxels. Throws std::runtime_error if the file is
// damaged.
VoxelBuffer read_voxels(const VdbGrids& file, const std::string& name, const Index<3>& dims,
                        std::size_t type, const std::vector<std::uint64_t>& runs);

}  // namespace leaflight
