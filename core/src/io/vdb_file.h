// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <filesystem>
#include <iosfwd>

#include "math/affine.h"

namespace leaflight {

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap::Ptr metadata;
};

// Throws Error.
VdbFile read_vdb(const std::filesystem::path& path);

// Into a stream that can be sought: what openvdb::io::File would write. The values of field_grid()
// are written as those of any grid of floats.
void write_vdb(std::ostream& stream, const openvdb::GridPtrVec& grids,
               const openvdb::MetaMap& metadata);

// OpenVDB's dense layout with x fastest.
template <class T>
using DenseView = openvdb::tools::Dense<T, openvdb::tools::LayoutXYZ>;

// OpenVDB refuses transforms whose voxels are smaller than 3e-15, and judges by differences of
// 1e-15 whether axes are alike: small voxels are written 2^k times larger, beside k. This is the k
// that voxels need.
int doublings_for(const Affine<3>& index_to_world);

void place(openvdb::GridBase& grid, const Affine<3>& index_to_world, int doublings);

// Index to world; path: of the file that the grid is from. Throws Error.
Affine<3> affine_of(const openvdb::GridBase& grid, const std::filesystem::path& path);

}  // namespace leaflight
