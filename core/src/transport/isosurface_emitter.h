// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/discrete_distribution.h"
#include "math/random.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// The emission of all isosurfaces of a volume within the isovalue_range ("level sets could emit
// their own illumination", thesis 4.3.3), from both sides. Since dA dc = |grad c| dV, a point of
// the volume stands for the isosurface that passes it, and no isosurface needs to be extracted.
template <int D>
class IsosurfaceEmitter {
 public:
  IsosurfaceEmitter(const SceneTracer<D>& tracer, int volume);

  // Power integrated over the common isovalue, in units of the isovalue range's height, averaged
  // over the channels and estimated at the middles of cells: what emitters are chosen by.
  double power_height() const { return by_power_.total(); }
  // An upper bound, roughly, of the largest channel of a sample's flux-height.
  double largest_flux_height() const { return 16 * power_height(); }

  struct Sample {
    SurfacePoint<D> point;  // kind none: no light from there
    Rgb flux_height;        // of all isosurfaces, as this photon alone would carry it
  };
  Sample sample(double choice, Random& random) const;

 private:
  struct Brick {
    Index<D> low, high;  // cells
  };
  const SceneTracer<D>& tracer_;
  int volume_;
  std::vector<Brick> bricks_;  // those that emit
  DiscreteDistribution by_power_;
};

}  // namespace leaflight
