// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/sampling.h"

namespace leaflight {

// A sphere around everything that rays can hit.
template <int D>
struct BoundingSphere {
  Vec<D> center{0.0};
  double radius = 0;

  // Samples the origin of a parallel photon, on a disc as large as the sphere and outside it.
  Vec<D> parallel_origin(const Vec<D>& direction, const std::array<double, 2>& u) const {
    return center + (sample_facing_disc<D>(direction, u) - direction) * radius;
  }
  // Returns the area of that disc, or its length in 2D.
  double parallel_area() const { return unit_disc<D> * spread<D>(radius); }
};

}  // namespace leaflight
