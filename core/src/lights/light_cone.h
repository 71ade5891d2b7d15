// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "base/vector.h"

namespace leaflight {

// The cone into which a spot emits.
template <int D>
struct LightCone {
  Vec<D> axis;                  // unit
  double cosine = 0;            // cosine of the half angle
  double blend = 0;             // in [0,1]: part of 1 - cosine over which the edge fades
  bool cosine_falloff = false;  // true for Blender 3.4's spots, which also fade with the cosine

  // Returns the share of the intensity for a unit direction away from the light. The edge is
  // smooth, as in Blender.
  double share(const Vec<D>& direction) const {
    const double along = direction.dot(axis);
    const double inside = along - cosine;
    if (!(inside > 0)) return 0;
    const double edge = (1 - cosine) * blend;
    const double t = inside < edge ? inside / edge : 1;
    const double falloff = cosine_falloff ? std::max(0.0, along) : 1;
    return falloff * t * t * (3 - 2 * t);
  }
  bool operator==(const LightCone& other) const {
    return axis == other.axis && cosine == other.cosine && blend == other.blend &&
           cosine_falloff == other.cosine_falloff;
  }
};

}  // namespace leaflight
