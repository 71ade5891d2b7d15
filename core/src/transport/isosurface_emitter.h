// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/discrete_distribution.h"
#include "base/random.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// The emission of all isosurfaces of a volume within the isovalue range, from both sides (thesis
// 4.3.3: "level sets could emit their own illumination"). Since dA dc = |grad c| dV, a point of the
// volume represents the isosurface through it. So no isosurface is extracted.
template <int D>
class IsosurfaceEmitter {
 public:
  IsosurfaceEmitter(const SceneTracer<D>& tracer, int volume);

  // Returns the power, integrated over the common isovalue and averaged over the channels. The unit
  // of isovalues is the height of the isovalue range. It is estimated at the centers of cells.
  // Emitters are chosen by it.
  double power_height() const { return by_power_.total(); }
  // Returns an approximate upper bound on the largest channel of a sample's flux-height.
  double largest_flux_height() const { return 16 * power_height(); }

  struct Sample {
    SurfacePoint<D> point;  // kind none: no light from there
    Rgb flux_height;        // of all isosurfaces, if this were the only photon
  };
  Sample sample(double choice, Random& random) const;

 private:
  struct Brick {
    Index<D> low, high;  // cells
  };
  const SceneTracer<D>& tracer_;
  int volume_;
  std::vector<Brick> bricks_;  // only emissive bricks
  DiscreteDistribution by_power_;
};

}  // namespace leaflight
