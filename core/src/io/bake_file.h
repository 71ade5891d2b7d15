// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "bake/driver/bake.h"
#include "io/dense_volume.h"

namespace leaflight {

using Metadata = std::map<std::string, std::string>;

// Writes a bake. Each volume has the grids `field`, `radiance`, `radiance_indirect` and
// `radiance_error`. If baked, it also has `radiance_back` and `radiance_back_indirect`. Vectors are
// half precision on disk. Bakes that can be continued have `unfiltered` and `unfiltered_back`.
// Grids of light are sparse: there are no texels where no isosurface passes. From the second volume
// on, the names end in _2, _3, ... The walls' radiance is the grid `walls_indirect` over (vertex,
// node of c, 2 mesh + side). The `metadata` goes to the first radiance grid, except for "id" and
// "statistics", which go to the file. Writes a temporary file and renames it. Throws Error.
void write_bake(const std::filesystem::path& path, const std::vector<const Field<3>*>& fields,
                const Baked<3>& baked, const Metadata& metadata,
                const Progress* progress = nullptr);

struct StoredBake {
  std::vector<DenseVolume> fields;
  // The walls have radiance, but neither meshes nor isovalue range; attach() adds them.
  Baked<3> baked;
  Metadata metadata;
};
StoredBake read_bake(const std::filesystem::path& path);

// Reads the metadata of any .vdb file, from its first bytes only. Throws Error.
Metadata read_bake_header(const std::filesystem::path& path);

}  // namespace leaflight
