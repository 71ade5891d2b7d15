// SPDX-License-Identifier: GPL-3.0-or-later
// Files that OpenVDB accepts. Their grids and metadata have the names of a bake but any content,
// and any texels follow them. The target reads the file, and draws it if it is a bake.
#include <openvdb/openvdb.h>

#include "bake/output/lit_contour.h"
#include "bytes.h"
#include "input_file.h"
#include "io/bake_file.h"
#include "io/bake_texels.h"
#include "io/vdb_file.h"
#include "io/vdb_volume.h"
#include "one_thread.h"
#include "said.h"

namespace {

using namespace leaflight;

constexpr std::array<const char*, 6> names{"field",          "radiance", "radiance_back",
                                           "walls_indirect", "field_2",  "radiance_2"};

// Small numbers mostly, so that grids fit each other.
int number(fuzz::Bytes& bytes) {
  return bytes.choice(8) == 0 ? bytes.take<std::int32_t>() : bytes.choice(8);
}

void add_metadata(openvdb::GridBase& grid, fuzz::Bytes& bytes) {
  openvdb::Vec3i dims;
  for (int a = 0; a < 3; ++a) dims[a] = number(bytes);
  if (bytes.choice(8) != 0) grid.insertMeta("leaflight_dims", openvdb::Vec3IMetadata(dims));
  constexpr std::array<const char*, 4> types{"float32", "uint8", "int16", "uint16"};
  grid.insertMeta("leaflight_type", openvdb::StringMetadata(types[bytes.choice(4)]));
  if (bytes.choice(4) == 0) {
    grid.insertMeta("leaflight_doublings", openvdb::Int32Metadata(number(bytes)));
  }
  if (bytes.choice(4) == 0) {
    grid.insertMeta("leaflight_meshes", openvdb::Int32Metadata(number(bytes)));
  }
}

template <class Grid, class Take>
openvdb::GridBase::Ptr grid_of(fuzz::Bytes& bytes, const Take& take) {
  const auto grid = Grid::create(take());
  auto accessor = grid->getAccessor();
  for (int count = bytes.choice(32); count > 0 && !bytes.empty(); --count) {
    openvdb::Coord at;
    for (int a = 0; a < 3; ++a) at[a] = number(bytes);
    accessor.setValue(at, take());
  }
  if (bytes.choice(8) == 0) {
    const openvdb::Coord low{number(bytes), number(bytes), number(bytes)};
    grid->tree().addTile(1 + bytes.choice(3), low, take(), bytes.choice(2) != 0);
  }
  return grid;
}

openvdb::GridBase::Ptr next_grid(fuzz::Bytes& bytes) {
  const char* name = names[bytes.choice(names.size())];
  const bool numbers = (std::string(name).find("field") == 0) != (bytes.choice(16) == 0);
  const auto scalar = [&] { return bytes.take<float>(); };
  const auto color = [&] { return openvdb::Vec3f{scalar(), scalar(), scalar()}; };
  const auto grid = numbers ? grid_of<openvdb::FloatGrid>(bytes, scalar)
                            : grid_of<openvdb::Vec3SGrid>(bytes, color);
  grid->setName(name);
  add_metadata(*grid, bytes);
  if (bytes.choice(8) == 0) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int row = 0; row < 4; ++row) {
      for (int i = 0; i < 3; ++i) matrix(row, i) = bytes.take<float>();
    }
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  }
  return grid;
}

// Writes texels whose sizes fit each other, or any bytes.
void write_behind(std::ostream& stream, fuzz::Bytes& bytes) {
  if (bytes.choice(2) == 0) {
    const auto begin = static_cast<std::uint64_t>(stream.tellp());
    while (!bytes.empty()) stream.put(bytes.take<char>());
    end_texels(stream, begin);
    return;
  }
  RadianceGrid<3> grid;
  Index<3> resolution;
  for (int& n : resolution) n = 2 + bytes.choice(4);
  grid.lattice = inactive_lattice<3>({2, 2, 2}, resolution);
  std::vector<std::uint32_t> active;
  for (std::uint32_t t = 0; t < cell_count<3>(resolution); ++t) {
    if (bytes.choice(2) == 0) active.push_back(t);
  }
  grid.lattice.activate(active);
  const auto light = [&] {
    std::vector<Vec<3, float>> light(active.size());
    for (auto& color : light) color = Vec<3, float>(bytes.take<float>());
    return light;
  };
  grid.radiance = light();
  grid.radiance_indirect = light();
  if (bytes.choice(2) == 0) {
    grid.radiance_back = light();
    grid.radiance_back_indirect = light();
  }
  grid.radiance_error.resize(active.size());
  std::vector<std::uint64_t> runs;
  for (int count = bytes.choice(4); count > 0; --count) runs.push_back(number(bytes));
  write_texels(stream, {&grid}, {runs});
}

void write(const std::filesystem::path& path, fuzz::Bytes& bytes) {
  openvdb::GridPtrVec grids;
  for (int count = bytes.choice(names.size() + 1); count > 0; --count) {
    const auto grid = next_grid(bytes);
    const bool is_new = std::none_of(grids.begin(), grids.end(), [&](const auto& other) {
      return other->getName() == grid->getName();
    });
    if (is_new) grids.push_back(grid);
  }
  openvdb::MetaMap metadata;
  metadata.insertMeta("leaflight_version", openvdb::StringMetadata("2"));
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  write_vdb(stream, grids, metadata);
  write_behind(stream, bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::OneThread one_thread;
  static const fuzz::InputFile file;
  openvdb::initialize();
  fuzz::Bytes bytes(data, size);
  try {
    write(file.path(), bytes);
  } catch (const openvdb::Exception&) {
    return 0;  // a transform that OpenVDB does not write
  }
  fuzz::accepted([&] {
    const StoredBake bake = read_bake(file.path());
    for (std::size_t v = 0; v < bake.fields.size(); ++v) {
      const DenseVolume& volume = bake.fields[v];
      const Field<3> field =
          make_field<3>(voxels_of(volume.values), volume.dims, volume.index_to_world, nullptr);
      LitContourSettings settings;
      settings.radiance = bake.baked.grids[v].has_light(false);
      settings.radiance_back =
          bake.baked.grids[v].has_back() && bake.baked.grids[v].has_light(true);
      LitMesh mesh;
      lit_contour(bake.baked.grids[v], field, (field.min + field.max) / 2, settings, mesh);
    }
  });
  fuzz::accepted([&] { read_vdb_volume(file.path(), ""); });
  return 0;
}
