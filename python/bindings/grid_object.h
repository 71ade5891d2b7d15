// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/output/radiance_grid.h"

namespace leaflight::python {

// A radiance grid for Python, with its lights and texture as baked or changed.
template <int D>
struct GridObject {
  std::shared_ptr<RadianceGrid<D>> baked;
  std::shared_ptr<const Field<D>> lit;           // the lit field; null: a grid from a file lacks it
  std::shared_ptr<const Field<D>> field;         // field in changed light; null: as baked
  std::shared_ptr<const DirectLight<D>> direct;  // null without a field
  Vec<3, float> indirect{1, 1, 1};
  std::shared_ptr<const VolumeTexture<D>> texture;  // null: none

  explicit GridObject(RadianceGrid<D>&& grid)
      : baked(std::make_shared<RadianceGrid<D>>(std::move(grid))), texture(baked->texture) {}

  ShownGrid<D> shown() const {
    ShownGrid<D> shown =
        field ? ShownGrid<D>(*baked, direct.get(), indirect) : ShownGrid<D>(*baked);
    shown.texture = texture.get();
    return shown;
  }
};

}  // namespace leaflight::python
