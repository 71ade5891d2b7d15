// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <filesystem>
#include <iosfwd>

#include "base/affine.h"

namespace leaflight {

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap::Ptr metadata;
};

// Reads all grids of a file. Throws Error.
VdbFile read_vdb(const std::filesystem::path& path);

// Writes the same bytes as openvdb::io::File to a seekable stream. Values of field_grid() are
// written like those of any grid of floats.
void write_vdb(std::ostream& stream, const openvdb::GridPtrVec& grids,
               const openvdb::MetaMap& metadata);

// OpenVDB's dense layout with x fastest.
template <class T>
using DenseView = openvdb::tools::Dense<T, openvdb::tools::LayoutXYZ>;

// Returns the k for which voxels are written 2^k times larger. OpenVDB refuses voxels smaller than
// 3e-15, and compares axes with a tolerance of 1e-15. The file also stores k.
int doublings_for(const Affine<3>& index_to_world);

void place(openvdb::GridBase& grid, const Affine<3>& index_to_world, int doublings);

// Returns the index-to-world transform. path: of the grid's file. Throws Error.
Affine<3> affine_of(const openvdb::GridBase& grid, const std::filesystem::path& path);

}  // namespace leaflight
