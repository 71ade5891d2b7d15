// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/bake_file.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/platform.h"
#include "io/bake_texels.h"
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

constexpr char field_name[] = "field", radiance_name[] = "radiance", back_name[] = "radiance_back",
               walls_name[] = "walls_indirect";
// Prefix that distinguishes our keys from OpenVDB's, such as "name".
const std::string metadata_prefix = "leaflight_";
// The version of the file, in its metadata.
constexpr char version_key[] = "version", version[] = "2";

// Names of the types of Voxels, in its order. OpenVDB has no grids of bytes or shorts, so voxels
// are written as floats with the name of their type.
constexpr std::array<const char*, 4> type_names{"float32", "uint8", "int16", "uint16"};
constexpr char type_key[] = "leaflight_type";

// Upper bound on the texels of a grid for other programs.
constexpr std::size_t most_shown_texels = 2'500'000;

constexpr int nodes = IsovalueNodes::count;
// More than the vertices of the largest walls that a bake can light (SurfaceCache).
constexpr int most_vertices = 1 << 22;

openvdb::Vec3f to_vdb(const Vec<3, float>& v) { return {v.x, v.y, v.z}; }
Vec<3, float> from_vdb(const openvdb::Vec3f& v) { return {v.x(), v.y(), v.z()}; }

openvdb::Vec3i to_vdb(const Index<3>& i) { return {i[0], i[1], i[2]}; }

Error damaged_bake(const std::filesystem::path& path) {
  return Error("'" + text_of(path) + "' is a damaged bake; bake again.");
}

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

// Returns all light of one side for other programs, at every texel or at every second, fourth, ...
// one along each axis.
Vec3Grid::Ptr shown_grid(const std::string& name, const Field<3>& field,
                         const RadianceGrid<3>& from, bool back, int doublings) {
  const TexelLattice<3>& lattice = from.lattice;
  int step = 1;
  for (std::size_t texels = from.texels(); texels > most_shown_texels; texels /= 8) step *= 2;
  std::vector<std::pair<openvdb::Coord, std::size_t>> texels;
  for (std::size_t s = 0; s < lattice.active_texels; ++s) {
    const Index<3> t = lattice.texel(lattice.active[s]);
    if (t[0] % step != 0 || t[1] % step != 0 || t[2] % step != 0) continue;
    texels.emplace_back(openvdb::Coord(t[0] / step, t[1] / step, t[2] / step), s);
  }
  SideRadiance radiance(texels.size());
  tbb::parallel_for(std::size_t{0}, texels.size(), [&](std::size_t i) {
    radiance[i] = radiance_of_texel(from, field, texels[i].second, back);
  });
  auto grid = Vec3Grid::create();
  auto accessor = grid->getAccessor();
  for (std::size_t i = 0; i < texels.size(); ++i) {
    accessor.setValue(texels[i].first, to_vdb(radiance[i]));
  }
  Affine<3> texel_to_world = texel_to_world_of(field, lattice);
  for (Vec3& column : texel_to_world.column) column *= step;
  grid->setName(name);
  place(*grid, texel_to_world, doublings);
  grid->setSaveFloatAsHalf(true);
  return grid;
}

openvdb::FloatGrid::Ptr placed_field(const Field<3>& field, std::size_t volume, int doublings) {
  auto values = field_grid(field);
  values->setName(numbered(field_name, volume));
  place(*values, field.index_to_world, doublings);
  values->insertMeta(type_key, openvdb::StringMetadata(type_names[field.values.index()]));
  values->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(field.dims)));
  return values;
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
  const std::uint64_t bytes = sizeof(float) * voxels, here = machine_memory();
  if (voxels > std::numeric_limits<std::int32_t>::max() && here > 0 && bytes > here) {
    throw Error("'" + text_of(path) + "': its " + std::to_string(voxels) + " voxels need " +
                std::to_string(bytes >> 30) + " GiB of memory, but there are " +
                std::to_string(here >> 30) + " GiB; open it on a larger machine.");
  }
  return {dims->value()[0], dims->value()[1], dims->value()[2]};
}

// Reads the walls. The largest side gives the number of vertices; attach() checks it against the
// meshes.
void read_walls(const VdbGrids& file, const std::filesystem::path& path, WallRadiance<3>& walls) {
  if (!file.has(walls_name)) return;
  const auto grid = openvdb::gridPtrCast<Vec3Grid>(file.read(walls_name));
  if (!grid) throw damaged_bake(path);
  const auto meshes = grid->getMetadata<openvdb::Int32Metadata>("leaflight_meshes");
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  const int count = meshes ? meshes->value() : -1;
  if (count < 0 || (!box.empty() && (box.min().x() < 0 || box.min().y() < 0 || box.min().z() < 0 ||
                                     box.max().x() >= most_vertices || box.max().y() >= nodes ||
                                     box.max().z() / 2 >= count))) {
    throw damaged_bake(path);
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

// Reads the metadata of a grid. Throws Error if there is no such grid.
openvdb::GridBase::Ptr grid_without_values(const VdbGrids& file, const std::string& name,
                                           const std::filesystem::path& path) {
  std::ifstream stream = file.stream();
  if (auto grid = file.topology(name, stream)) return grid;
  throw Error("'" + text_of(path) + "' is not a Leaflight bake, as it has no grid '" + name +
              "'; choose a file written by a bake.");
}

DenseVolume read_field(const VdbGrids& file, std::size_t volume,
                       const std::vector<std::uint64_t>& runs, const std::filesystem::path& path) {
  const std::string name = numbered(field_name, volume);
  const auto grid = grid_without_values(file, name, path);
  DenseVolume field;
  field.dims = dims_from(*grid, path);
  field.index_to_world = affine_of(*grid, path);
  field.name = field_name;
  const auto type = grid->getMetadata<openvdb::StringMetadata>(type_key);
  const auto found =
      std::find(type_names.begin(), type_names.end(), type ? type->value() : type_names[0]);
  field.values = read_voxels(file, name, field.dims, found - type_names.begin(), runs);
  return field;
}

// Returns the metadata of the file, and a reader of its texels. Throws Error if it is no bake.
TexelReader open_texels(const VdbGrids& file, const std::filesystem::path& path, bool sealed,
                        Metadata& metadata) {
  add_texts(file.metadata(), metadata);
  const auto found = metadata.find(version_key);
  if (found == metadata.end() || found->second != version) {
    // Other programs write no texts of ours.
    throw Error(metadata.empty()
                    ? "'" + text_of(path) +
                          "' is not a Leaflight bake; choose a file written by a bake."
                    : "'" + text_of(path) +
                          "' is a bake of another version of Leaflight; bake the volume again.");
  }
  metadata.erase(found);
  std::optional<TexelReader> reader = TexelReader::open(path, length_without_seal(path, sealed));
  if (!reader) throw damaged_bake(path);
  return std::move(*reader);
}

StoredBake read_parts(const std::filesystem::path& path, bool sealed, Progress& progress) {
  const VdbGrids file(path);
  StoredBake bake;
  TexelReader texels = open_texels(file, path, sealed, bake.metadata);
  for (std::size_t v = 0; v < texels.volumes(); ++v) {
    bake.fields.push_back(read_field(file, v, texels.runs(), path));
    const auto voxels = static_cast<double>(cell_count<3>(bake.fields[v].dims));
    progress.expect_more(voxels);
    progress.check();
    bake.baked.grids.push_back(texels.grid(bake.fields[v].dims));
    progress.advance(voxels);
    progress.check();
  }
  read_walls(file, path, bake.baked.walls);
  add_texts(*grid_without_values(file, radiance_name, path), bake.metadata);
  return bake;
}

}  // namespace

void write_bake(const std::filesystem::path& path, const std::vector<const Field<3>*>& fields,
                const BakeParts& baked, const Metadata& metadata, const Progress* progress) {
  // All grids use the same scale, so that they match in other programs too.
  int doublings = 0;
  for (std::size_t v = 0; v < fields.size(); ++v) {
    const TexelLattice<3>& lattice = baked.grids[v]->lattice;
    doublings = std::max(doublings, doublings_for(texel_to_world_of(*fields[v], lattice)));
    doublings = std::max(doublings, doublings_for(fields[v]->index_to_world));
  }
  openvdb::GridPtrVec grids;
  std::vector<openvdb::FloatGrid::Ptr> values;
  for (std::size_t v = 0; v < fields.size(); ++v) {
    values.push_back(placed_field(*fields[v], v, doublings));
    grids.push_back(values.back());
    for (const bool back : {false, true}) {
      if (back && !baked.grids[v]->has_back()) continue;
      grids.push_back(shown_grid(numbered(back ? back_name : radiance_name, v), *fields[v],
                                 *baked.grids[v], back, doublings));
    }
  }
  openvdb::MetaMap file_metadata;
  file_metadata.insertMeta(metadata_prefix + version_key, openvdb::StringMetadata(version));
  for (const auto& [key, value] : metadata) {
    const openvdb::StringMetadata text(value);
    if (key == "id" || key == "statistics") {
      file_metadata.insertMeta(metadata_prefix + key, text);
    } else {
      grids[1]->insertMeta(metadata_prefix + key, text);
    }
  }
  if (baked.walls && !baked.walls->empty()) grids.push_back(walls_grid(*baked.walls));
  const auto write = [&](std::ostream& stream) {
    write_vdb(stream, grids, file_metadata);
    std::vector<std::vector<std::uint64_t>> runs;
    runs.reserve(values.size());
    for (const auto& grid : values) runs.push_back(runs_of(*grid));
    write_texels(stream, baked.grids, runs);
  };
  replace_file(path, write, progress, true);
}

StoredBake read_bake(const std::filesystem::path& path, Progress* progress) {
  const Seal seal = check_seal(path);
  if (seal == Seal::broken) {
    throw Error("'" + text_of(path) +
                "' is damaged, because its checksum is wrong; fetch it again, or bake again.");
  }
  StoredBake bake;
  Progress none;
  check_vdb(path,
            [&] { bake = read_parts(path, seal == Seal::whole, progress ? *progress : none); });
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
