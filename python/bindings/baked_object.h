// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "arrays.h"
#include "bake/output/baked.h"
#include "grid_object.h"

namespace leaflight::python {

// A bake as grids and walls, separate objects that live as long as Python uses them.
template <int D>
struct BakedObjects {
  std::vector<std::shared_ptr<GridObject<D>>> grids;
  std::shared_ptr<WallRadiance<D>> walls;
  BakeStatistics statistics;
  std::size_t texels = 0;

  BakedObjects(Baked<D>&& baked, const Scene<D>& scene) : statistics(std::move(baked.statistics)) {
    for (RadianceGrid<D>& grid : baked.grids) {
      texels += grid.texels();
      const Field<D>& lit = scene.volumes[grids.size()].field;
      grids.push_back(std::make_shared<GridObject<D>>(std::move(grid)));
      grids.back()->lit = std::make_shared<const Field<D>>(lit);
    }
    if (!baked.walls.empty()) {
      walls = std::make_shared<WallRadiance<D>>(std::move(baked.walls));
    }
  }
};

}  // namespace leaflight::python
