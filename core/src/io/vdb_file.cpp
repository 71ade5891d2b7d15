// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vdb_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/error.h"
#include "io/files.h"

namespace leaflight {
namespace {

constexpr char doublings_key[] = "leaflight_doublings";
constexpr int most_doublings = 100;

void initialize() {
  static const bool done = [] {
    openvdb::initialize();
    return true;
  }();
  static_cast<void>(done);
}

Affine<3> doubled(Affine<3> m, int times) {
  for (Vec3& column : m.column) column *= std::ldexp(1.0, times);
  m.origin *= std::ldexp(1.0, times);
  return m;
}

openvdb::math::Transform::Ptr to_transform(const Affine<3>& m) {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) matrix(a, i) = m.column[a][i];
    matrix(3, a) = m.origin[a];
  }
  return openvdb::math::Transform::createLinearTransform(matrix);
}

// Writes grids to a seekable stream, which Archive offers only to derived classes. File can do it
// too, but does not notice a full disk.
class SeekableArchive : openvdb::io::Archive {
 public:
  // Writes like Archive::write(), for grids with unique names.
  void write_into(std::ostream& stream, const openvdb::GridPtrVec& grids,
                  const openvdb::MetaMap& metadata) const {
    auto stream_metadata = std::make_shared<openvdb::io::StreamMetadata>();
    openvdb::io::setStreamMetadataPtr(stream, stream_metadata, false);
    openvdb::io::setWriteGridStatsMetadata(stream, true);
    openvdb::io::setDataCompression(stream, compression());
    writeHeader(stream, true);
    metadata.writeMeta(stream);
    const auto count = static_cast<std::int32_t>(grids.size());
    stream.write(reinterpret_cast<const char*>(&count), sizeof count);
    for (const auto& grid : grids) {
      const bool floats = std::dynamic_pointer_cast<openvdb::FloatGrid>(grid) != nullptr;
      openvdb::io::GridDescriptor descriptor(grid->getName(),
                                             floats ? openvdb::FloatGrid::gridType() : grid->type(),
                                             grid->saveFloatAsHalf());
      writeGrid(descriptor, grid, stream, true);
      // Reset, because a grid may have its own compression.
      openvdb::io::setDataCompression(stream, compression());
    }
  }
};

}  // namespace

// Reads a file and converts OpenVDB's exceptions to one sentence. OpenVDB does not notice that a
// file ends early, and would use sizes that it never read. Our stream throws instead.
VdbFile read_vdb(const std::filesystem::path& path) {
  require_file(path);
  initialize();
  const auto damaged = [&](const std::string& why) {
    return Error("'" + text_of(path) + "' is not a readable OpenVDB file (" + why +
                 "); check that it is complete.");
  };
  try {
    std::ifstream stream(path, std::ios::binary);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream file(stream, false);
    return {*file.getGrids(), file.getMetadata()};
  } catch (const std::ios::failure&) {
    throw damaged("it ends early");
  } catch (const std::exception& problem) {
    throw damaged(brief(problem.what()));
  }
}

void write_vdb(std::ostream& stream, const openvdb::GridPtrVec& grids,
               const openvdb::MetaMap& metadata) {
  initialize();
  SeekableArchive().write_into(stream, grids, metadata);
}

int doublings_for(const Affine<3>& index_to_world) {
  const double edge = std::cbrt(std::abs(determinant(index_to_world)));
  return edge >= 1e-4 ? 0
                      : std::min(most_doublings, static_cast<int>(-std::floor(std::log2(edge))));
}

void place(openvdb::GridBase& grid, const Affine<3>& index_to_world, int doublings) {
  grid.setTransform(to_transform(doubled(index_to_world, doublings)));
  if (doublings > 0) grid.insertMeta(doublings_key, openvdb::Int32Metadata(doublings));
}

Affine<3> affine_of(const openvdb::GridBase& grid, const std::filesystem::path& path) {
  const openvdb::math::Transform& transform = grid.transform();
  if (!transform.isLinear()) {
    throw Error("A grid of '" + text_of(path) +
                "' has a perspective transform; resample it to a linear one.");
  }
  const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
  Affine<3> m;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) m.column[a][i] = matrix(a, i);
    m.origin[a] = matrix(3, a);
  }
  if (const auto doublings = grid.getMetadata<openvdb::Int32Metadata>(doublings_key)) {
    m = doubled(m, -std::clamp(doublings->value(), 0, most_doublings));
  }
  return m;
}

}  // namespace leaflight
