// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vdb_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "base/error.h"
#include "base/progress.h"
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

void check_vdb(const std::filesystem::path& path, const std::function<void()>& read) {
  const auto damaged = [&](const std::string& why) {
    return Error("'" + text_of(path) + "' is not a readable OpenVDB file (" + why +
                 "); check that it is complete.");
  };
  try {
    read();
  } catch (const Error&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::ios::failure&) {
    throw damaged("it ends early");
  } catch (const std::exception& problem) {
    throw damaged(brief(problem.what()));
  }
}

// OpenVDB does not notice that a file ends early, and would use sizes that it never read. Our
// stream throws instead.
VdbFile read_vdb(const std::filesystem::path& path) {
  require_file(path);
  initialize();
  VdbFile found;
  check_vdb(path, [&] {
    std::ifstream stream(path, std::ios::binary);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream file(stream, false);
    found = {*file.getGrids(), file.getMetadata()};
  });
  return found;
}

namespace {

// Reads grids in any order, which Archive offers only to derived classes. File can do it too, but
// opens no path with characters of other languages on Windows.
class GridReader : openvdb::io::Archive {
 public:
  // Reads to the first grid.
  GridReader(std::ifstream& stream, openvdb::MetaMap& metadata) : stream_(stream) {
    readHeader(stream);
    setFormatVersion(stream);
    setLibraryVersion(stream);
    setDataCompression(stream);
    metadata.readMeta(stream);
  }
  std::map<std::string, openvdb::io::GridDescriptor> places() {
    constexpr int most_grids = 1000;
    std::map<std::string, openvdb::io::GridDescriptor> places;
    const int count = readGridCount(stream_);
    if (!inputHasGridOffsets() || count < 0 || count > most_grids) {
      throw std::runtime_error("its grids cannot be read one by one");
    }
    for (int i = 0; i < count; ++i) {
      openvdb::io::GridDescriptor place;
      place.read(stream_);
      place.seekToEnd(stream_);
      places.emplace(openvdb::io::GridDescriptor::stripSuffix(place.uniqueName()), place);
    }
    return places;
  }
  openvdb::GridBase::Ptr topology(const openvdb::io::GridDescriptor& place) {
    openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(place.gridType());
    grid->setSaveFloatAsHalf(place.saveFloatAsHalf());
    place.seekToGrid(stream_);
    readGridCompression(stream_);
    grid->readMeta(stream_);
    grid->readTransform(stream_);
    grid->readTopology(stream_);
    place.seekToBlocks(stream_);
    return grid;
  }

 private:
  std::ifstream& stream_;
};

}  // namespace

VdbGrids::VdbGrids(std::filesystem::path path)
    : path_(std::move(path)), length_(require_file(path_)) {
  initialize();
  std::ifstream in_file = stream();
  places_ = GridReader(in_file, metadata_).places();
}

openvdb::GridBase::Ptr VdbGrids::read(const std::string& name) const {
  std::ifstream in_file = stream();
  openvdb::GridBase::Ptr grid = topology(name, in_file);
  if (grid) grid->readBuffers(in_file);
  return grid;
}

openvdb::GridBase::Ptr VdbGrids::topology(const std::string& name, std::ifstream& stream) const {
  const auto place = places_.find(name);
  if (place == places_.end()) return nullptr;
  openvdb::MetaMap metadata;
  return GridReader(stream, metadata).topology(place->second);
}

std::ifstream VdbGrids::stream() const {
  std::ifstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  stream.open(path_, std::ios::binary);
  return stream;
}

std::string VdbGrids::bytes(std::uint64_t begin, std::uint64_t end) const {
  if (begin > end || end > length_) throw std::runtime_error("a part of it is elsewhere");
  std::ifstream in_file = stream();
  std::string bytes(end - begin, '\0');
  in_file.seekg(static_cast<std::streamoff>(begin));
  in_file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
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
