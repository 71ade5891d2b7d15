// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "bake/driver/bake.h"
#include "io/dense_volume.h"

namespace leaflight {

using Metadata = std::map<std::string, std::string>;

// One bake: of each volume the grids `field`, `radiance`, `radiance_indirect` and, if baked,
// `radiance_back` and `radiance_back_indirect` (vec3, half on disk) and `radiance_error`, and for
// bakes that go on `unfiltered` and `unfiltered_back`, sparse: no texel where no isosurface passes.
// From the second volume on their names end in _2, _3, ... The walls' radiance is the grid
// `walls_indirect` over (vertex, node of c, 2 mesh + side). `metadata` goes to the first
// radiance grid, but for the keys "id" and "statistics", which belong to the file itself. Written
// under a temporary name and renamed. Throws Error.
void write_bake(const std::filesystem::path& path, const std::vector<const Field<3>*>& fields,
                const Baked<3>& baked, const Metadata& metadata,
                const Progress* progress = nullptr);

struct StoredBake {
  std::vector<DenseVolume> fields;
  // The walls have their radiance, but neither meshes nor isovalue range yet: attach() adds them.
  Baked<3> baked;
  Metadata metadata;
};
StoredBake read_bake(const std::filesystem::path& path);

// The metadata of the file itself, of any .vdb: reads its first bytes alone. Throws Error.
Metadata read_bake_header(const std::filesystem::path& path);

}  // namespace leaflight
