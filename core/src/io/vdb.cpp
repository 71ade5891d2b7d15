// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/io/vdb.h"

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
               indirect_name[] = "radiance_indirect", error_name[] = "radiance_error";
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

openvdb::FloatGrid::Ptr field_grid(const Field<3>& field) {
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
  grid->setName(field_name);
  grid->setTransform(to_transform(field.index_to_world));
  return grid;
}

template <class Grid, class Value>
typename Grid::Ptr texel_grid(const char* name, const Affine<3>& texel_to_world,
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

// Reads a whole file and turns what OpenVDB throws into one sentence. OpenVDB does not notice that
// a file ends early and goes on with sizes it never read, hence a stream of ours that throws.
Contents read_file(const std::string& path) {
  require_file(path);
  initialize();
  const auto damaged = [&](const std::string& why) {
    return Error("'" + path + "' is not a readable OpenVDB file (" + why +
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

template <class Grid>
typename Grid::Ptr require_grid(const Contents& file, const char* name, const std::string& path) {
  for (const auto& grid : file.grids) {
    if (grid->getName() != name) continue;
    if (const auto found = openvdb::gridPtrCast<Grid>(grid)) return found;
  }
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

void write_bake(const std::string& path, const Field<3>& field, const RadianceGrid<3>& grid,
                const Metadata& metadata) {
  initialize();
  const TexelLattice<3>& lattice = grid.lattice;
  Affine<3> texel_to_world = field.index_to_world;
  for (int a = 0; a < 3; ++a) texel_to_world.column[a] *= lattice.voxels_per_texel[a];

  const auto values = field_grid(field);
  values->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(field.dims)));
  const auto radiance =
      texel_grid<openvdb::Vec3SGrid>(radiance_name, texel_to_world, lattice,
                                     [&](std::size_t s) { return to_vdb(grid.radiance[s]); });
  radiance->insertMeta("leaflight_dims", openvdb::Vec3IMetadata(to_vdb(lattice.resolution)));
  openvdb::MetaMap file_metadata;
  for (const auto& [key, value] : metadata) {
    const openvdb::StringMetadata text(value);
    if (key == "statistics") {
      file_metadata.insertMeta(metadata_prefix + key, text);
    } else {
      radiance->insertMeta(metadata_prefix + key, text);
    }
  }
  const auto indirect = texel_grid<openvdb::Vec3SGrid>(
      indirect_name, texel_to_world, lattice,
      [&](std::size_t s) { return to_vdb(grid.radiance_indirect[s]); });
  const auto error = texel_grid<openvdb::FloatGrid>(
      error_name, texel_to_world, lattice, [&](std::size_t s) { return grid.radiance_error[s]; });
  write_atomically(path, [&](const std::string& temporary) {
    openvdb::io::File file(temporary);
    file.write(openvdb::GridCPtrVec{values, radiance, indirect, error}, file_metadata);
  });
}

StoredBake read_bake(const std::string& path) {
  const Contents file = read_file(path);
  StoredBake bake;
  const auto values = require_grid<openvdb::FloatGrid>(file, field_name, path);
  const auto radiance = require_grid<openvdb::Vec3SGrid>(file, radiance_name, path);
  const auto indirect = require_grid<openvdb::Vec3SGrid>(file, indirect_name, path);
  const auto error = require_grid<openvdb::FloatGrid>(file, error_name, path);

  bake.field.dims = dims_from(*values, path);
  bake.field.index_to_world = to_affine(values->transform(), path);
  bake.field.name = field_name;
  bake.field.values.resize(cell_count<3>(bake.field.dims));
  DenseView<float> dense(box_of(bake.field.dims), bake.field.values.data());
  openvdb::tools::copyToDense(*values, dense);
  for (float& h : bake.field.values) h = h == values->background() ? nan : h;

  TexelLattice<3>& lattice = bake.grid.lattice;
  lattice = inactive_lattice<3>(bake.field.dims, dims_from(*radiance, path));
  const openvdb::CoordBBox box = box_of(lattice.resolution);
  for (auto texel = radiance->cbeginValueOn(); texel; ++texel) {
    if (!texel.isVoxelValue() || !box.isInside(texel.getCoord())) {
      throw Error("'" + path + "' is a damaged bake; bake again.");
    }
    const openvdb::Coord t = texel.getCoord();
    lattice.active.push_back(static_cast<std::uint32_t>(lattice.linear({t[0], t[1], t[2]})));
  }
  std::sort(lattice.active.begin(), lattice.active.end());
  const auto direct_access = radiance->getConstAccessor();
  const auto indirect_access = indirect->getConstAccessor();
  const auto error_access = error->getConstAccessor();
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    lattice.slot[lattice.active[s]] = static_cast<std::int32_t>(s);
    const Index<3> t = lattice.texel(lattice.active[s]);
    const openvdb::Coord coord(t[0], t[1], t[2]);
    bake.grid.radiance.push_back(from_vdb(direct_access.getValue(coord)));
    bake.grid.radiance_indirect.push_back(from_vdb(indirect_access.getValue(coord)));
    bake.grid.radiance_error.push_back(error_access.getValue(coord));
  }
  const openvdb::MetaMap::ConstPtr of_file = file.metadata;
  for (const openvdb::MetaMap* source :
       {of_file.get(), static_cast<const openvdb::MetaMap*>(radiance.get())}) {
    for (auto entry = source->beginMeta(); entry != source->endMeta(); ++entry) {
      const openvdb::Metadata& value = *entry->second;
      if (entry->first.rfind(metadata_prefix, 0) == 0 &&
          value.typeName() == openvdb::StringMetadata::staticTypeName()) {
        bake.metadata[entry->first.substr(metadata_prefix.size())] = value.str();
      }
    }
  }
  return bake;
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
