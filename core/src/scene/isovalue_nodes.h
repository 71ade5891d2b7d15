// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scene/scene.h"

namespace leaflight {

// The common isovalues at which the light of the walls is known, between which it is linear.
// They are as dense as the isosurfaces are: half of the spacing follows the isovalue range, half
// the share of the volumes between two nodes, since where isosurfaces are far apart their light
// differs much.
class IsovalueNodes {
 public:
  static constexpr int count = 33;

  IsovalueNodes() = default;
  template <int D>
  explicit IsovalueNodes(const Scene<D>& scene);

  double node(int i) const { return nodes_[i]; }
  // Of the common isovalues that are nearer to a node than to any other.
  double height(int i) const;
  int nearest(double c) const;

  // c = node(low) (1 - t) + node(low + 1) t, t in [0,1].
  struct Place {
    int low;
    double t;
  };
  Place place(double c) const;

 private:
  std::array<double, count> nodes_{};
};

}  // namespace leaflight
