// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/bake_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/platform.h"
#include "io/field_grid.h"
#include "io/files.h"
#include "io/replaced_files.h"
#include "io/seal.h"
#include "io/vdb_file.h"
#include "io/vdb_header.h"

namespace leaflight {
namespace {

using Vec3Grid = openvdb::Vec3SGrid;
using SideRadiance = std::vector<Vec<3, float>>;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr char field_name[] = "field", radiance_name[] = "radiance",
               indirect_name[] = "radiance_indirect", error_name[] = "radiance_error",
               back_name[] = "radiance_back", back_indirect_name[] = "radiance_back_indirect",
               unfiltered_name[] = "unfiltered", unfiltered_back_name[] = "unfiltered_back",
               walls_name[] = "walls_indirect",
               // Name in bakes of earlier versions, with direct light.
    old_walls_name[] = "surroundings_radiance";
// Prefix that distinguishes our keys from OpenVDB's, such as "name".
const std::string metadata_prefix = "leaflight_";

// Names of the types of Voxels, in its order. OpenVDB has no grids of bytes or shorts, so voxels
// are written as floats with the name of their type.
constexpr std::array<const char*, 4> type_names{"float32", "uint8", "int16", "uint16"};
constexpr char type_key[] = "leaflight_type";

constexpr int nodes = IsovalueNodes::count;

openvdb::CoordBBox box_of(const Index<3>& dims) {
  return {openvdb::Coord(0), openvdb::Coord(dims[0] - 1, dims[1] - 1, dims[2] - 1)};
}

openvdb::Vec3f to_vdb(const Vec<3, float>& v) { return {v.x, v.y, v.z}; }
Vec<3, float> from_vdb(const openvdb::Vec3f& v) { return {v.x(), v.y(), v.z()}; }

openvdb::Vec3i to_vdb(const Index<3>& i) { return {i[0], i[1], i[2]}; }

// Appends the number of a volume to a grid's name, except for the first volume.
std::string numbered(const char* name, std::size_t volume) {
  std::string text = name;
  if (volume > 0) text += "_" + std::to_string(volume + 1);
  return text;
}

Affine<3> texel_to_world_of(const Field<3>& field, const TexelLattice<3>& lattice) {
  Affine<3> texel_to_world = field.index_to_world;
  for (int a = 0; a < 3; ++a) texel_to_world.column[a] *= lattice.voxels_per_texel[a];
  return texel_to_world;
}

template <class Grid, class Value>
typename Grid::Ptr texel_grid(const std::string& name, const Affine<3>& texel_to_world,
                              int doublings, const TexelLattice<3>& lattice, Value value) {
  auto grid = Grid::create();
  auto accessor = grid->getAccessor();
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    const Index<3> t = lattice.texel(lattice.active[s]);
    accessor.setValue(openvdb::Coord(t[0], t[1], t[2]), value(s));
  }
  grid->setName(name);
  place(*grid, texel_to_world, doublings);
  grid->setSaveFloatAsHalf(true);
  return grid;
}

void add_radiance(openvdb::GridPtrVec& grids, std::size_t volume, const Field<3>& field,
                  const RadianceGrid<3>& from, int doublings) {
  const TexelLattice<3>& lattice = from.lattice;
  const Affine<3> texel_to_world = texel_to_world_of(field, lattice);
  const auto add = [&](const char* name, const SideRadiance& radiance) {
    grids.push_back(texel_grid<Vec3Grid>(numbered(name, volume), texel_to_world, doublings, lattice,
                                         [&](std::size_t s) { return to_vdb(radiance[s]); }));
  };
  add(radiance_name, from.radiance);
  grids.back()->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(lattice.resolution)));
  add(indirect_name, from.radiance_indirect);
  if (from.has_back()) {
    add(back_name, from.radiance_back);
    add(back_indirect_name, from.radiance_back_indirect);
  }
  grids.push_back(texel_grid<openvdb::FloatGrid>(
      numbered(error_name, volume), texel_to_world, doublings, lattice,
      [&](std::size_t s) { return from.radiance_error[s]; }));
}

void add_unfiltered(openvdb::GridPtrVec& grids, std::size_t volume, const Field<3>& field,
                    const UnfilteredLight<3>& light, int doublings) {
  TexelLattice<3> lattice = inactive_lattice<3>(field.dims, light.resolution);
  lattice.activate(light.texels);
  for (int side = 0; side < 2; ++side) {
    const SideRadiance& values = light.sides[side];
    if (values.empty()) continue;
    grids.push_back(
        texel_grid<Vec3Grid>(numbered(side == 0 ? unfiltered_name : unfiltered_back_name, volume),
                             texel_to_world_of(field, lattice), doublings, lattice,
                             [&](std::size_t s) { return to_vdb(values[s]); }));
    grids.back()->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(lattice.resolution)));
  }
}

void add_volume(openvdb::GridPtrVec& grids, std::size_t volume, const Field<3>& field,
                const RadianceGrid<3>& grid, int doublings) {
  const auto values = field_grid(field);
  values->setName(numbered(field_name, volume));
  place(*values, field.index_to_world, doublings);
  values->insertMeta(type_key, openvdb::StringMetadata(type_names[field.values.index()]));
  values->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(field.dims)));
  grids.push_back(values);
  add_radiance(grids, volume, field, grid, doublings);
  if (!grid.unfiltered.texels.empty()) {
    add_unfiltered(grids, volume, field, grid.unfiltered, doublings);
  }
}

Vec3Grid::Ptr walls_grid(const WallRadiance<3>& walls) {
  auto grid = Vec3Grid::create();
  auto accessor = grid->getAccessor();
  for (std::size_t m = 0; m < walls.radiance.size(); ++m) {
    for (int side = 0; side < 2; ++side) {
      const SideRadiance& radiance = walls.radiance[m][side];
      const std::size_t vertices = radiance.size() / nodes;
      for (std::size_t i = 0; i < radiance.size(); ++i) {
        const openvdb::Coord coord(static_cast<int>(i % vertices), static_cast<int>(i / vertices),
                                   static_cast<int>(2 * m + side));
        accessor.setValue(coord, to_vdb(radiance[i]));
      }
    }
  }
  grid->setName(walls_name);
  grid->setSaveFloatAsHalf(true);
  grid->insertMeta("leaflight_meshes",
                   openvdb::Int32Metadata(static_cast<int>(walls.radiance.size())));
  return grid;
}

// Copies our text entries of the metadata.
void add_texts(const openvdb::MetaMap& from, Metadata& to) {
  for (auto entry = from.beginMeta(); entry != from.endMeta(); ++entry) {
    const openvdb::Metadata& value = *entry->second;
    if (entry->first.rfind(metadata_prefix, 0) == 0 &&
        value.typeName() == openvdb::StringMetadata::staticTypeName()) {
      to[entry->first.substr(metadata_prefix.size())] = value.str();
    }
  }
}

template <class Grid>
typename Grid::Ptr find_grid(const VdbFile& file, const std::string& name) {
  for (const auto& grid : file.grids) {
    if (grid->getName() != name) continue;
    if (auto found = openvdb::gridPtrCast<Grid>(grid)) return found;
  }
  return nullptr;
}

template <class Grid>
typename Grid::Ptr require_grid(const VdbFile& file, const std::string& name,
                                const std::filesystem::path& path) {
  if (auto found = find_grid<Grid>(file, name)) return found;
  throw Error("'" + text_of(path) + "' is not a Leaflight bake, as it has no grid '" + name +
              "'; choose a file written by a bake.");
}

Index<3> dims_from(const openvdb::GridBase& grid, const std::filesystem::path& path) {
  const auto dims = grid.getMetadata<openvdb::Vec3IMetadata>("leaflight_dims");
  std::uint64_t voxels = 1;
  if (dims) {
    for (int a = 0; a < 3; ++a) {
      const int n = dims->value()[a];
      voxels *= n >= 2 && n <= 65535 ? n : 0;
    }
  }
  if (!dims || voxels == 0) {
    throw Error("'" + text_of(path) + "' is not a Leaflight bake, or a damaged one; bake again.");
  }
  // Voxels are floats here, once in the grid and once in order.
  const std::uint64_t bytes = 2 * sizeof(float) * voxels, here = machine_memory();
  if (voxels > std::numeric_limits<std::int32_t>::max() && here > 0 && bytes > here) {
    throw Error("'" + text_of(path) + "': its " + std::to_string(voxels) + " voxels need " +
                std::to_string(bytes >> 30) + " GiB of memory, but there are " +
                std::to_string(here >> 30) + " GiB; open it on a larger machine.");
  }
  return {dims->value()[0], dims->value()[1], dims->value()[2]};
}

template <class Value>
VoxelBuffer narrowed(const std::vector<float>& values, const std::filesystem::path& path) {
  using Limits = std::numeric_limits<Value>;
  const bool fit = std::all_of(values.begin(), values.end(), [](float h) {
    return h >= Limits::lowest() && h <= Limits::max() && h == std::trunc(h);
  });
  if (!fit) throw Error("'" + text_of(path) + "' is a damaged bake; bake again.");
  return std::vector<Value>(values.begin(), values.end());
}

// Converts voxels to the type that the grid's metadata names.
VoxelBuffer in_own_type(std::vector<float>&& values, const openvdb::GridBase& grid,
                        const std::filesystem::path& path) {
  const auto type = grid.getMetadata<openvdb::StringMetadata>(type_key);
  const std::string name = type ? type->value() : "";
  if (name == type_names[1]) return narrowed<std::uint8_t>(values, path);
  if (name == type_names[2]) return narrowed<std::int16_t>(values, path);
  if (name == type_names[3]) return narrowed<std::uint16_t>(values, path);
  return std::move(values);
}

DenseVolume read_field(const VdbFile& file, std::size_t volume, const std::filesystem::path& path) {
  const auto grid = require_grid<openvdb::FloatGrid>(file, numbered(field_name, volume), path);
  DenseVolume field;
  field.dims = dims_from(*grid, path);
  field.index_to_world = affine_of(*grid, path);
  field.name = field_name;
  std::vector<float> values(cell_count<3>(field.dims));
  DenseView<float> dense(box_of(field.dims), values.data());
  openvdb::tools::copyToDense(*grid, dense);
  for (float& h : values) h = h == grid->background() ? nan : h;
  field.values = in_own_type(std::move(values), *grid, path);
  return field;
}

// Reads the active texels of a grid. `dims`: voxels of the volume.
TexelLattice<3> read_lattice(const Vec3Grid& grid, const Index<3>& dims,
                             const std::filesystem::path& path) {
  const Index<3> resolution = dims_from(grid, path);
  check_resolution<3>(resolution);
  TexelLattice<3> lattice = inactive_lattice<3>(dims, resolution);
  const openvdb::CoordBBox box = box_of(resolution);
  std::vector<std::uint32_t> active;
  for (auto texel = grid.cbeginValueOn(); texel; ++texel) {
    if (!texel.isVoxelValue() || !box.isInside(texel.getCoord())) {
      throw Error("'" + text_of(path) + "' is a damaged bake; bake again.");
    }
    const openvdb::Coord t = texel.getCoord();
    active.push_back(static_cast<std::uint32_t>(lattice.linear({t[0], t[1], t[2]})));
  }
  std::sort(active.begin(), active.end());
  lattice.activate(std::move(active));
  return lattice;
}

SideRadiance texels_of(const Vec3Grid& grid, const TexelLattice<3>& lattice) {
  const auto access = grid.getConstAccessor();
  SideRadiance found;
  found.reserve(lattice.active.size());
  for (const std::uint32_t texel : lattice.active) {
    const Index<3> t = lattice.texel(texel);
    found.push_back(from_vdb(access.getValue(openvdb::Coord(t[0], t[1], t[2]))));
  }
  return found;
}

UnfilteredLight<3> read_unfiltered(const VdbFile& file, std::size_t volume, const Index<3>& dims,
                                   const std::filesystem::path& path) {
  const auto front = find_grid<Vec3Grid>(file, numbered(unfiltered_name, volume));
  if (!front) return {};
  const TexelLattice<3> lattice = read_lattice(*front, dims, path);
  UnfilteredLight<3> light{lattice.resolution, lattice.active, {}};
  light.sides[0] = texels_of(*front, lattice);
  const auto back = find_grid<Vec3Grid>(file, numbered(unfiltered_back_name, volume));
  if (back) light.sides[1] = texels_of(*back, lattice);
  return light;
}

RadianceGrid<3> read_radiance(const VdbFile& file, std::size_t volume, const Index<3>& dims,
                              const std::filesystem::path& path) {
  const auto name = [&](const char* base) { return numbered(base, volume); };
  const auto radiance = require_grid<Vec3Grid>(file, name(radiance_name), path);
  const auto indirect = require_grid<Vec3Grid>(file, name(indirect_name), path);
  const auto error = require_grid<openvdb::FloatGrid>(file, name(error_name), path);
  const auto back = find_grid<Vec3Grid>(file, name(back_name));
  RadianceGrid<3> found;
  found.lattice = read_lattice(*radiance, dims, path);
  const TexelLattice<3>& lattice = found.lattice;
  found.radiance = texels_of(*radiance, lattice);
  found.radiance_indirect = texels_of(*indirect, lattice);
  if (back) {
    const auto back_indirect = find_grid<Vec3Grid>(file, name(back_indirect_name));
    if (!back_indirect) {
      throw Error("'" + text_of(path) +
                  "' is a bake of an earlier version; bake the volume again.");
    }
    found.radiance_back = texels_of(*back, lattice);
    found.radiance_back_indirect = texels_of(*back_indirect, lattice);
  }
  const auto error_access = error->getConstAccessor();
  for (const std::uint32_t texel : lattice.active) {
    const Index<3> t = lattice.texel(texel);
    found.radiance_error.push_back(error_access.getValue(openvdb::Coord(t[0], t[1], t[2])));
  }
  found.unfiltered = read_unfiltered(file, volume, dims, path);
  return found;
}

// Reads the walls. The largest side gives the number of vertices; attach() checks it against the
// meshes.
void read_walls(const VdbFile& file, const std::filesystem::path& path, WallRadiance<3>& walls) {
  const auto grid = find_grid<Vec3Grid>(file, walls_name);
  if (!grid && find_grid<Vec3Grid>(file, old_walls_name)) {
    throw Error("'" + text_of(path) + "' is a bake of an earlier version; bake the volume again.");
  }
  if (!grid) return;
  const auto meshes = grid->getMetadata<openvdb::Int32Metadata>("leaflight_meshes");
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  const int count = meshes ? meshes->value() : -1;
  if (count < 0 || (!box.empty() && (box.min().x() < 0 || box.min().y() < 0 || box.min().z() < 0 ||
                                     box.max().x() >= 1 << 20 || box.max().y() >= nodes ||
                                     box.max().z() / 2 >= count))) {
    throw Error("'" + text_of(path) + "' is a damaged bake; bake again.");
  }
  walls.radiance.resize(count);
  std::vector<int> vertices(2 * static_cast<std::size_t>(count), 0);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    vertices[at.z()] = std::max(vertices[at.z()], at.x() + 1);
  }
  for (std::size_t s = 0; s < vertices.size(); ++s) {
    walls.radiance[s / 2][s % 2].assign(static_cast<std::size_t>(vertices[s]) * nodes,
                                        Vec<3, float>(0));
  }
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    SideRadiance& side = walls.radiance[at.z() / 2][at.z() % 2];
    side[static_cast<std::size_t>(at.y()) * vertices[at.z()] + at.x()] = from_vdb(*value);
  }
}

}  // namespace

void write_bake(const std::filesystem::path& path, const std::vector<const Field<3>*>& fields,
                const Baked<3>& baked, const Metadata& metadata, const Progress* progress) {
  // All grids use the same scale, so that they match in other programs too.
  int doublings = 0;
  for (std::size_t v = 0; v < fields.size(); ++v) {
    const TexelLattice<3>& lattice = baked.grids[v].lattice;
    doublings = std::max(doublings, doublings_for(texel_to_world_of(*fields[v], lattice)));
    doublings = std::max(doublings, doublings_for(fields[v]->index_to_world));
  }
  openvdb::GridPtrVec grids;
  for (std::size_t v = 0; v < fields.size(); ++v) {
    add_volume(grids, v, *fields[v], baked.grids[v], doublings);
  }
  openvdb::MetaMap file_metadata;
  for (const auto& [key, value] : metadata) {
    const openvdb::StringMetadata text(value);
    if (key == "id" || key == "statistics") {
      file_metadata.insertMeta(metadata_prefix + key, text);
    } else {
      grids[1]->insertMeta(metadata_prefix + key, text);
    }
  }
  if (!baked.walls.empty()) grids.push_back(walls_grid(baked.walls));
  const auto write = [&](std::ostream& stream) { write_vdb(stream, grids, file_metadata); };
  replace_file(path, write, progress, true);
}

StoredBake read_bake(const std::filesystem::path& path) {
  if (check_seal(path) == Seal::broken) {
    throw Error("'" + text_of(path) +
                "' is damaged, because its checksum is wrong; fetch it again, or bake again.");
  }
  const VdbFile file = read_vdb(path);
  StoredBake bake;
  for (std::size_t v = 0; v == 0 || find_grid<openvdb::FloatGrid>(file, numbered(field_name, v));
       ++v) {
    bake.fields.push_back(read_field(file, v, path));
    bake.baked.grids.push_back(read_radiance(file, v, bake.fields[v].dims, path));
  }
  read_walls(file, path, bake.baked.walls);
  const auto radiance = require_grid<Vec3Grid>(file, radiance_name, path);
  add_texts(*file.metadata, bake.metadata);
  add_texts(*radiance, bake.metadata);
  return bake;
}

Metadata read_bake_header(const std::filesystem::path& path) {
  Metadata metadata;
  for (const auto& [name, text] : read_vdb_texts(path)) {
    if (name.rfind(metadata_prefix, 0) == 0) metadata[name.substr(metadata_prefix.size())] = text;
  }
  return metadata;
}

}  // namespace leaflight
