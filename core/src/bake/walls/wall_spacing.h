// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/box.h"
#include "scene/scene.h"

namespace leaflight {

// How far apart vertices of the walls are at most. It grows with the distance from the volumes,
// as the penumbrae of their shadows do: a gap of a voxel under an isosurface is seen, and a wall
// far away has no vertices to spare.
template <int D>
class WallSpacing {
 public:
  explicit WallSpacing(const Scene<D>& scene);

  // World units.
  double at(const Vec<D>& place) const { return slope_ * (distance(place) + closest_); }

 private:
  double distance(const Vec<D>& place) const;  // from the nearest volume's box
  double expected_pieces(const Scene<D>& scene) const;

  std::vector<Box<D>> volumes_;
  double closest_, slope_;
};

}  // namespace leaflight
