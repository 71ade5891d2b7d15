// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "bake/driver/bake.h"
#include "io/dense_volume.h"

namespace leaflight {

using Metadata = std::map<std::string, std::string>;

// The parts of a bake that a file holds.
struct BakeParts {
  std::vector<const RadianceGrid<3>*> grids;  // one per volume
  const WallRadiance<3>* walls = nullptr;     // null: none

  BakeParts() = default;
  BakeParts(const Baked<3>& baked) : walls(&baked.walls) {  // NOLINT: implicit, to write all of it
    for (const RadianceGrid<3>& grid : baked.grids) grids.push_back(&grid);
  }
};

// Writes a bake, which must have the precision of a file (radiance_grid.h). OpenVDB reads the grids
// `field`, `radiance` and, if baked, `radiance_back` of each volume. The last two are for other
// programs: they have all light, of at most 2.5 million texels, in half precision. From the second
// volume on, the names end in _2, _3, ... The walls' radiance is the grid `walls_indirect` over
// (vertex, node of c, 2 mesh + side). The light that Leaflight reads follows (bake_texels.h). The
// `metadata` goes to the first radiance grid, except for "id" and "statistics", which go to the
// file. Writes a temporary file and renames it. Throws Error.
void write_bake(const std::filesystem::path& path, const std::vector<const Field<3>*>& fields,
                const BakeParts& baked, const Metadata& metadata,
                const Progress* progress = nullptr);

struct StoredBake {
  std::vector<DenseVolume> fields;
  // The grids need their direct light. The walls have radiance, but neither meshes nor isovalue
  // range; attach() adds them.
  Baked<3> baked;
  Metadata metadata;
};
// Throws Error, or Cancelled.
StoredBake read_bake(const std::filesystem::path& path, Progress* progress = nullptr);

// Reads the metadata of any .vdb file, from its first bytes only. Throws Error.
Metadata read_bake_header(const std::filesystem::path& path);

}  // namespace leaflight
