// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "base/affine.h"

namespace leaflight {

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap::Ptr metadata;
};

// Reads all grids of a file. Throws Error.
VdbFile read_vdb(const std::filesystem::path& path);

// Calls read(). Converts exceptions to one sentence about the OpenVDB file.
void check_vdb(const std::filesystem::path& path, const std::function<void()>& read);

// The grids of a file, which are read one by one. All functions throw any exception.
class VdbGrids {
 public:
  // Reads the metadata of the file and the places of its grids.
  explicit VdbGrids(std::filesystem::path path);

  const openvdb::MetaMap& metadata() const { return metadata_; }
  bool has(const std::string& name) const { return places_.count(name) > 0; }
  // Returns a grid with this name, or null.
  openvdb::GridBase::Ptr read(const std::string& name) const;
  // Returns a grid without the values of its leaf nodes, or null. The stream() is then at these
  // values, and OpenVDB's state of it is that of the grid as long as the grid exists.
  openvdb::GridBase::Ptr topology(const std::string& name, std::ifstream& stream) const;
  // Returns a stream that throws.
  std::ifstream stream() const;
  // Returns the bytes of [begin, end) of the file.
  std::string bytes(std::uint64_t begin, std::uint64_t end) const;

 private:
  std::filesystem::path path_;
  std::uint64_t length_;
  openvdb::MetaMap metadata_;
  std::map<std::string, openvdb::io::GridDescriptor> places_;
};

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
