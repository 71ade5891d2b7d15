// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/box.h"
#include "scene/scene.h"

namespace leaflight {

// Upper bound on the distance between vertices of the walls. It grows with the distance from the
// volumes, as the penumbrae of their shadows do.
template <int D>
class WallSpacing {
 public:
  explicit WallSpacing(const Scene<D>& scene);

  // Returns the spacing in world units.
  double at(const Vec<D>& place) const { return slope_ * (distance(place) + closest_); }

 private:
  double distance(const Vec<D>& place) const;  // from the nearest volume's box
  double expected_pieces(const Scene<D>& scene) const;

  std::vector<Box<D>> volumes_;
  double closest_, slope_;
};

}  // namespace leaflight
