// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vdb_volume.h"

#include <limits>

#include "base/error.h"
#include "io/files.h"
#include "io/vdb_file.h"

namespace leaflight {
namespace {

template <class Grid>
bool read_as(const openvdb::GridBase::Ptr& base, const std::filesystem::path& path,
             DenseVolume& volume) {
  const auto grid = openvdb::gridPtrCast<Grid>(base);
  if (!grid) return false;
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (box.empty()) {
    throw Error("The grid '" + brief(grid->getName()) + "' of '" + text_of(path) +
                "' has no active voxels; choose another grid.");
  }
  std::uint64_t voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t n = std::int64_t{box.max()[a]} - box.min()[a] + 1;
    if (n > 65535 || (voxels *= n) > std::numeric_limits<std::int32_t>::max()) {
      throw Error("The grid '" + brief(grid->getName()) + "' of '" + text_of(path) +
                  "' is too large for a dense volume; crop or resample it.");
    }
    volume.dims[a] = static_cast<int>(n);
  }
  std::vector<float> values(voxels);
  DenseView<float> dense(box, values.data());
  openvdb::tools::copyToDense(*grid, dense);
  volume.values = std::move(values);
  volume.name = brief(grid->getName());
  volume.index_to_world = affine_of(*grid, path);
  volume.index_to_world.origin =
      volume.index_to_world.point(Vec3(box.min().x(), box.min().y(), box.min().z()));
  return true;
}

bool read_scalar(const openvdb::GridBase::Ptr& grid, const std::filesystem::path& path,
                 DenseVolume& volume) {
  return read_as<openvdb::FloatGrid>(grid, path, volume) ||
         read_as<openvdb::DoubleGrid>(grid, path, volume) ||
         read_as<openvdb::Int32Grid>(grid, path, volume) ||
         read_as<openvdb::Int64Grid>(grid, path, volume);
}

}  // namespace

DenseVolume read_vdb_volume(const std::filesystem::path& path, const std::string& grid_name) {
  const VdbFile file = read_vdb(path);
  DenseVolume volume;
  std::string names;
  for (const auto& grid : file.grids) {
    const std::string name = grid->getName();
    names += (names.empty() ? "" : ", ") + name;
    if (!grid_name.empty() && name != grid_name) continue;
    if (read_scalar(grid, path, volume)) return volume;
    if (!grid_name.empty()) {
      throw Error("The grid '" + grid_name + "' of '" + text_of(path) +
                  "' does not hold scalars; choose another grid.");
    }
  }
  throw Error(grid_name.empty()
                  ? "'" + text_of(path) + "' has no scalar grid; it has: " + brief(names) + "."
                  : "'" + text_of(path) + "' has no grid '" + grid_name +
                        "'; it has: " + brief(names) + ".");
}

}  // namespace leaflight
