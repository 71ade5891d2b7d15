// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "base/affine.h"
#include "field/voxels.h"
#include "scene/color_ramp.h"

namespace leaflight {

// Colors over the domain of a volume, by the values of a second grid.
template <int D>
struct VolumeTexture {
  struct Channel {
    Voxels values;
    std::shared_ptr<const void> owner;  // owner of the values
  };
  // One channel, or red, green and blue. Each of three takes its component of the colors.
  std::vector<Channel> channels;
  Index<D> dims{};
  Affine<D> to_texture;  // from positions for at(), in a scene index positions of the lit volume
  ColorRamp colors;      // over the values, in [0,1]
  bool nearest = false;  // value of the nearest voxel, as for labels; false: interpolates

  // Returns the color at a position. It is white where there is no value: farther than half a voxel
  // outside the grid, and next to NaN.
  Rgb at(const Vec<D>& position) const;
};

}  // namespace leaflight
