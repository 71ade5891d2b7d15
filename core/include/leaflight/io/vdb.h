// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "leaflight/bake/radiance_grid.h"
#include "leaflight/io/dense_volume.h"

namespace leaflight {

using Metadata = std::map<std::string, std::string>;

// One bake: the grids `field`, `radiance` and `radiance_indirect` (vec3, half on disk) and
// `radiance_error`, sparse: no texel where no leaf passes. `metadata` goes to the radiance grid;
// what belongs to the run and not to its result goes under the key "statistics" to the file itself.
// Written under a temporary name and renamed. Throws Error.
void write_bake(const std::string& path, const Field<3>& field, const RadianceGrid<3>& grid,
                const Metadata& metadata);

struct StoredBake {
  DenseVolume field;
  RadianceGrid<3> grid;
  Metadata metadata;
};
StoredBake read_bake(const std::string& path);

// A scalar grid of any .vdb as a dense volume over its active voxels; the first one if no name is
// given. Throws Error.
DenseVolume read_vdb_volume(const std::string& path, const std::string& grid_name);

}  // namespace leaflight
