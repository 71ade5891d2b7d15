// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/io/vdb.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <vector>

#include "leaflight/io/files.h"
#include "leaflight/math/error.h"

namespace leaflight {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr char field_name[] = "field", radiance_name[] = "radiance",
               indirect_name[] = "radiance_indirect", error_name[] = "radiance_error",
               back_name[] = "radiance_back", surroundings_name[] = "surroundings_radiance";
// Keeps our keys apart from OpenVDB's own, such as "name".
const std::string metadata_prefix = "leaflight_";

void initialize() {
  static const bool done = [] {
    openvdb::initialize();
    return true;
  }();
  static_cast<void>(done);
}

openvdb::math::Transform::Ptr to_transform(const Affine<3>& m) {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) matrix(a, i) = m.column[a][i];
    matrix(3, a) = m.origin[a];
  }
  return openvdb::math::Transform::createLinearTransform(matrix);
}

Affine<3> to_affine(const openvdb::math::Transform& transform, const std::string& path) {
  if (!transform.isLinear()) {
    throw Error("A grid of '" + path +
                "' has a perspective transform; resample it to a linear one.");
  }
  const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
  Affine<3> m;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) m.column[a][i] = matrix(a, i);
    m.origin[a] = matrix(3, a);
  }
  return m;
}

// OpenVDB's dense layout with x fastest.
template <class T>
using DenseView = openvdb::tools::Dense<T, openvdb::tools::LayoutXYZ>;

openvdb::CoordBBox box_of(const Index<3>& dims) {
  return {openvdb::Coord(0), openvdb::Coord(dims[0] - 1, dims[1] - 1, dims[2] - 1)};
}

openvdb::FloatGrid::Ptr field_grid(const std::string& name, const Field<3>& field) {
  // Masked voxels are inactive: OpenVDB cannot compare NaN, so they take a value of no other voxel.
  constexpr float lowest = std::numeric_limits<float>::lowest();
  const float masked = field.min > lowest ? lowest : std::numeric_limits<float>::infinity();
  auto grid = openvdb::FloatGrid::create(masked);
  std::vector<float> unmasked;
  if (field.masked) {
    unmasked.assign(field.values, field.values + field.voxels());
    for (float& h : unmasked) h = std::isnan(h) ? masked : h;
  }
  const float* values = field.masked ? unmasked.data() : field.values;
  const DenseView<float> dense(box_of(field.dims), const_cast<float*>(values));
  openvdb::tools::copyFromDense(dense, *grid, 0.0f);
  grid->setName(name);
  grid->setTransform(to_transform(field.index_to_world));
  return grid;
}

template <class Grid, class Value>
typename Grid::Ptr texel_grid(const std::string& name, const Affine<3>& texel_to_world,
                              const TexelLattice<3>& lattice, Value value) {
  auto grid = Grid::create();
  auto accessor = grid->getAccessor();
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    const Index<3> t = lattice.texel(lattice.active[s]);
    accessor.setValue(openvdb::Coord(t[0], t[1], t[2]), value(s));
  }
  grid->setName(name);
  grid->setTransform(to_transform(texel_to_world));
  grid->setSaveFloatAsHalf(true);
  return grid;
}

openvdb::Vec3f to_vdb(const Vec<3, float>& v) { return {v.x, v.y, v.z}; }
Vec<3, float> from_vdb(const openvdb::Vec3f& v) { return {v.x(), v.y(), v.z()}; }

openvdb::Vec3i to_vdb(const Index<3>& i) { return {i[0], i[1], i[2]}; }

struct Contents {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap::Ptr metadata;
};

// Calls read(stream) and turns what OpenVDB throws into one sentence. OpenVDB does not notice that
// a file ends early and goes on with sizes it never read, hence a stream of ours that throws.
template <class Read>
auto read_stream(const std::string& path, const Read& read) {
  require_file(path);
  initialize();
  const auto damaged = [&](const std::string& why) {
    return Error("'" + path + "' is not a readable OpenVDB file (" + why +
                 "); check that it is complete.");
  };
  try {
    std::ifstream stream(path, std::ios::binary);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    return read(stream);
  } catch (const std::ios::failure&) {
    throw damaged("it ends early");
  } catch (const std::exception& problem) {
    throw damaged(brief(problem.what()));
  }
}

Contents read_file(const std::string& path) {
  return read_stream(path, [](std::istream& stream) {
    openvdb::io::Stream file(stream, false);
    return Contents{*file.getGrids(), file.getMetadata()};
  });
}

// Archive leaves the reading of a header to its heirs.
struct Header : openvdb::io::Archive {
  using Archive::readHeader;
};

// Adds the texts among metadata that are ours.
void add_texts(const openvdb::MetaMap& from, Metadata& to) {
  for (auto entry = from.beginMeta(); entry != from.endMeta(); ++entry) {
    const openvdb::Metadata& value = *entry->second;
    if (entry->first.rfind(metadata_prefix, 0) == 0 &&
        value.typeName() == openvdb::StringMetadata::staticTypeName()) {
      to[entry->first.substr(metadata_prefix.size())] = value.str();
    }
  }
}

// Grids of the volumes after the first have a number, those of finer texels their level.
std::string numbered(const char* name, std::size_t volume, int level = 0) {
  std::string text = name;
  if (volume > 0) text += "_" + std::to_string(volume + 1);
  if (level > 0) text += "_level" + std::to_string(level);
  return text;
}

template <class Grid>
typename Grid::Ptr find_grid(const Contents& file, const std::string& name) {
  for (const auto& grid : file.grids) {
    if (grid->getName() != name) continue;
    if (const auto found = openvdb::gridPtrCast<Grid>(grid)) return found;
  }
  return nullptr;
}

template <class Grid>
typename Grid::Ptr require_grid(const Contents& file, const std::string& name,
                                const std::string& path) {
  if (const auto found = find_grid<Grid>(file, name)) return found;
  throw Error("'" + path + "' is not a Leaflight bake, as it has no grid '" + name +
              "'; choose a file written by a bake.");
}

Index<3> dims_from(const openvdb::GridBase& grid, const std::string& path) {
  const auto dims = grid.getMetadata<openvdb::Vec3IMetadata>("leaflight_dims");
  std::uint64_t voxels = 1;
  if (dims) {
    for (int a = 0; a < 3; ++a) {
      const int n = dims->value()[a];
      voxels *= n >= 2 && n <= 65535 ? n : 0;
    }
  }
  if (!dims || voxels == 0 || voxels > std::numeric_limits<std::int32_t>::max()) {
    throw Error("'" + path + "' is not a Leaflight bake, or a damaged one; bake again.");
  }
  return {dims->value()[0], dims->value()[1], dims->value()[2]};
}

template <class Grid>
bool read_as(const openvdb::GridBase::Ptr& base, const std::string& path, DenseVolume& volume) {
  const auto grid = openvdb::gridPtrCast<Grid>(base);
  if (!grid) return false;
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (box.empty()) {
    throw Error("The grid '" + brief(grid->getName()) + "' of '" + path +
                "' has no active voxels; choose another grid.");
  }
  std::uint64_t voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t n = std::int64_t{box.max()[a]} - box.min()[a] + 1;
    if (n > 65535 || (voxels *= n) > std::numeric_limits<std::int32_t>::max()) {
      throw Error("The grid '" + brief(grid->getName()) + "' of '" + path +
                  "' is too large for a dense volume; crop or resample it.");
    }
    volume.dims[a] = static_cast<int>(n);
  }
  volume.values.resize(voxels);
  DenseView<float> dense(box, volume.values.data());
  openvdb::tools::copyToDense(*grid, dense);
  volume.name = brief(grid->getName());
  volume.index_to_world = to_affine(grid->transform(), path);
  volume.index_to_world.origin =
      volume.index_to_world.point(Vec3(box.min().x(), box.min().y(), box.min().z()));
  return true;
}

bool read_scalar(const openvdb::GridBase::Ptr& grid, const std::string& path, DenseVolume& volume) {
  return read_as<openvdb::FloatGrid>(grid, path, volume) ||
         read_as<openvdb::DoubleGrid>(grid, path, volume) ||
         read_as<openvdb::Int32Grid>(grid, path, volume) ||
         read_as<openvdb::Int64Grid>(grid, path, volume);
}

}  // namespace

namespace {

using Vec3Grid = openvdb::Vec3SGrid;
using SideRadiance = std::vector<Vec<3, float>>;

void add_radiance(openvdb::GridPtrVec& grids, std::size_t volume, int level, const Field<3>& field,
                  const RadianceGrid<3>& grid) {
  const TexelLattice<3>& lattice = grid.lattice;
  Affine<3> texel_to_world = field.index_to_world;
  for (int a = 0; a < 3; ++a) texel_to_world.column[a] *= lattice.voxels_per_texel[a];
  const auto add = [&](const char* name, const SideRadiance& radiance) {
    grids.push_back(texel_grid<Vec3Grid>(numbered(name, volume, level), texel_to_world, lattice,
                                         [&](std::size_t s) { return to_vdb(radiance[s]); }));
  };
  add(radiance_name, grid.radiance);
  grids.back()->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(lattice.resolution)));
  add(indirect_name, grid.radiance_indirect);
  if (grid.has_back()) add(back_name, grid.radiance_back);
  grids.push_back(
      texel_grid<openvdb::FloatGrid>(numbered(error_name, volume, level), texel_to_world, lattice,
                                     [&](std::size_t s) { return grid.radiance_error[s]; }));
  if (grid.finer) add_radiance(grids, volume, level + 1, field, *grid.finer);
}

void add_volume(openvdb::GridPtrVec& grids, std::size_t volume, const Field<3>& field,
                const RadianceGrid<3>& grid) {
  const auto values = field_grid(numbered(field_name, volume), field);
  values->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(field.dims)));
  grids.push_back(values);
  add_radiance(grids, volume, 0, field, grid);
}

constexpr int nodes = LeafNodes::count;

Vec3Grid::Ptr surroundings_grid(const SurroundingsRadiance<3>& surroundings) {
  const auto grid = Vec3Grid::create();
  auto accessor = grid->getAccessor();
  for (std::size_t m = 0; m < surroundings.radiance.size(); ++m) {
    for (int side = 0; side < 2; ++side) {
      const SideRadiance& radiance = surroundings.radiance[m][side];
      const std::size_t vertices = radiance.size() / nodes;
      for (std::size_t i = 0; i < radiance.size(); ++i) {
        const openvdb::Coord coord(static_cast<int>(i % vertices), static_cast<int>(i / vertices),
                                   static_cast<int>(2 * m + side));
        accessor.setValue(coord, to_vdb(radiance[i]));
      }
    }
  }
  grid->setName(surroundings_name);
  grid->setSaveFloatAsHalf(true);
  grid->insertMeta("leaflight_meshes",
                   openvdb::Int32Metadata(static_cast<int>(surroundings.radiance.size())));
  return grid;
}

DenseVolume read_field(const Contents& file, std::size_t volume, const std::string& path) {
  const auto values = require_grid<openvdb::FloatGrid>(file, numbered(field_name, volume), path);
  DenseVolume field;
  field.dims = dims_from(*values, path);
  field.index_to_world = to_affine(values->transform(), path);
  field.name = field_name;
  field.values.resize(cell_count<3>(field.dims));
  DenseView<float> dense(box_of(field.dims), field.values.data());
  openvdb::tools::copyToDense(*values, dense);
  for (float& h : field.values) h = h == values->background() ? nan : h;
  return field;
}

RadianceGrid<3> read_radiance(const Contents& file, std::size_t volume, int level,
                              const Index<3>& dims, const std::string& path) {
  const auto name = [&](const char* base) { return numbered(base, volume, level); };
  const auto radiance = require_grid<Vec3Grid>(file, name(radiance_name), path);
  const auto indirect = require_grid<Vec3Grid>(file, name(indirect_name), path);
  const auto error = require_grid<openvdb::FloatGrid>(file, name(error_name), path);
  const auto back = find_grid<Vec3Grid>(file, name(back_name));
  RadianceGrid<3> grid;
  TexelLattice<3>& lattice = grid.lattice;
  lattice = inactive_lattice<3>(dims, dims_from(*radiance, path));
  const openvdb::CoordBBox box = box_of(lattice.resolution);
  std::vector<std::uint32_t> active;
  for (auto texel = radiance->cbeginValueOn(); texel; ++texel) {
    if (!texel.isVoxelValue() || !box.isInside(texel.getCoord())) {
      throw Error("'" + path + "' is a damaged bake; bake again.");
    }
    const openvdb::Coord t = texel.getCoord();
    active.push_back(static_cast<std::uint32_t>(lattice.linear({t[0], t[1], t[2]})));
  }
  std::sort(active.begin(), active.end());
  lattice.activate(std::move(active));
  const auto fetch = [&](const Vec3Grid& from, SideRadiance& into) {
    const auto access = from.getConstAccessor();
    for (const std::uint32_t texel : lattice.active) {
      const Index<3> t = lattice.texel(texel);
      into.push_back(from_vdb(access.getValue(openvdb::Coord(t[0], t[1], t[2]))));
    }
  };
  fetch(*radiance, grid.radiance);
  fetch(*indirect, grid.radiance_indirect);
  if (back) fetch(*back, grid.radiance_back);
  const auto error_access = error->getConstAccessor();
  for (const std::uint32_t texel : lattice.active) {
    const Index<3> t = lattice.texel(texel);
    grid.radiance_error.push_back(error_access.getValue(openvdb::Coord(t[0], t[1], t[2])));
  }
  if (find_grid<Vec3Grid>(file, numbered(radiance_name, volume, level + 1))) {
    grid.finer =
        std::make_shared<RadianceGrid<3>>(read_radiance(file, volume, level + 1, dims, path));
    for (int a = 0; a < 3; ++a) {
      if (grid.finer->lattice.resolution[a] != 2 * lattice.resolution[a] - 1 ||
          grid.finer->has_back() != grid.has_back()) {
        throw Error("'" + path + "' is a damaged bake; bake again.");
      }
    }
  }
  return grid;
}

// Their number of vertices is the largest that a side has; attach() checks it against the meshes.
void read_surroundings(const Contents& file, const std::string& path,
                       SurroundingsRadiance<3>& surroundings) {
  const auto grid = find_grid<Vec3Grid>(file, surroundings_name);
  if (!grid) return;
  const auto meshes = grid->getMetadata<openvdb::Int32Metadata>("leaflight_meshes");
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  const int count = meshes ? meshes->value() : -1;
  if (count < 0 || (!box.empty() && (box.min().x() < 0 || box.min().y() < 0 || box.min().z() < 0 ||
                                     box.max().x() >= 1 << 20 || box.max().y() >= nodes ||
                                     box.max().z() / 2 >= count))) {
    throw Error("'" + path + "' is a damaged bake; bake again.");
  }
  surroundings.radiance.resize(count);
  std::vector<int> vertices(2 * static_cast<std::size_t>(count), 0);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    vertices[at.z()] = std::max(vertices[at.z()], at.x() + 1);
  }
  for (std::size_t s = 0; s < vertices.size(); ++s) {
    surroundings.radiance[s / 2][s % 2].assign(static_cast<std::size_t>(vertices[s]) * nodes,
                                               Vec<3, float>(0));
  }
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    SideRadiance& side = surroundings.radiance[at.z() / 2][at.z() % 2];
    side[static_cast<std::size_t>(at.y()) * vertices[at.z()] + at.x()] = from_vdb(*value);
  }
}

}  // namespace

void write_bake(const std::string& path, const std::vector<const Field<3>*>& fields,
                const Baked<3>& baked, const Metadata& metadata) {
  initialize();
  openvdb::GridPtrVec grids;
  for (std::size_t v = 0; v < fields.size(); ++v) add_volume(grids, v, *fields[v], baked.grids[v]);
  openvdb::MetaMap file_metadata;
  for (const auto& [key, value] : metadata) {
    const openvdb::StringMetadata text(value);
    if (key == "id" || key == "statistics") {
      file_metadata.insertMeta(metadata_prefix + key, text);
    } else {
      grids[1]->insertMeta(metadata_prefix + key, text);
    }
  }
  if (!baked.surroundings.empty()) grids.push_back(surroundings_grid(baked.surroundings));
  write_atomically(path, [&](const std::string& temporary) {
    openvdb::io::File file(temporary);
    file.write(grids, file_metadata);
  });
}

StoredBake read_bake(const std::string& path) {
  const Contents file = read_file(path);
  StoredBake bake;
  for (std::size_t v = 0; v == 0 || find_grid<openvdb::FloatGrid>(file, numbered(field_name, v));
       ++v) {
    bake.fields.push_back(read_field(file, v, path));
    bake.baked.grids.push_back(read_radiance(file, v, 0, bake.fields[v].dims, path));
  }
  read_surroundings(file, path, bake.baked.surroundings);
  const auto radiance = require_grid<Vec3Grid>(file, radiance_name, path);
  add_texts(*file.metadata, bake.metadata);
  add_texts(*radiance, bake.metadata);
  return bake;
}

Metadata read_bake_header(const std::string& path) {
  return read_stream(path, [](std::istream& stream) {
    Header().readHeader(stream);
    openvdb::MetaMap of_file;
    of_file.readMeta(stream);
    Metadata metadata;
    add_texts(of_file, metadata);
    return metadata;
  });
}

DenseVolume read_vdb_volume(const std::string& path, const std::string& grid_name) {
  const Contents file = read_file(path);
  DenseVolume volume;
  std::string names;
  for (const auto& grid : file.grids) {
    const std::string name = grid->getName();
    names += (names.empty() ? "" : ", ") + name;
    if (!grid_name.empty() && name != grid_name) continue;
    if (read_scalar(grid, path, volume)) return volume;
    if (!grid_name.empty()) {
      throw Error("The grid '" + grid_name + "' of '" + path +
                  "' does not hold scalars; choose another grid.");
    }
  }
  throw Error(grid_name.empty() ? "'" + path + "' has no scalar grid; it has: " + brief(names) + "."
                                : "'" + path + "' has no grid '" + grid_name +
                                      "'; it has: " + brief(names) + ".");
}

}  // namespace leaflight
