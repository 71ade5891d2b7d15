// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scene/scene.h"

namespace leaflight {

// The common isovalues at which the light of the walls is stored; it is linear between them. Half
// of the spacing is uniform over the isovalue range. The other half follows the volumes' histogram,
// because light changes more where isosurfaces are far apart.
class IsovalueNodes {
 public:
  static constexpr int count = 33;

  IsovalueNodes() = default;
  template <int D>
  explicit IsovalueNodes(const Scene<D>& scene);

  double node(int i) const { return nodes_[i]; }
  // Returns the length of the interval of isovalues nearest to a node.
  double height(int i) const;
  int nearest(double c) const;

  // The position between two nodes: c = node(low) (1 - t) + node(low + 1) t, t in [0,1].
  struct Place {
    int low;
    double t;
  };
  Place place(double c) const;

 private:
  std::array<double, count> nodes_{};
};

}  // namespace leaflight
