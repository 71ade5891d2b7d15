// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <optional>

#include "base/sampling.h"
#include "lights/light_cone.h"

namespace leaflight {

// A direction from which a light may light a point.
template <int D>
struct LightSample {
  Vec<D> direction{0.0};  // unit, from the point towards the light
  bool infinite = false;  // true for suns and environments, which have no position
  Vec<D> end{0.0};        // point on the light, and its normal towards the lit point
  Vec<D> end_normal{0.0};
  Rgb radiance{0};  // divided by the density per angle; 0: no light from there
};

// A photon when it leaves a light.
template <int D>
struct EmittedPhoton {
  Vec<D> origin, direction;  // frame
  Rgb flux;                  // of the whole light, if this were the only photon
};

// A point of a light, or a direction of light from infinity, that represents the light. It lights
// the whole scene, unlike a LightSample, which is chosen for one lit point.
template <int D>
struct LightSource {
  bool infinite = false;
  bool both_sides = false;           // true if the light emits on both sides of its normal
  Vec<D> position{0.0};              // finite only
  Vec<D> direction{0.0};             // infinite only: unit, away from the light
  Vec<D> normal{0.0};                // finite only
  std::optional<LightCone<D>> cone;  // limits the light
  bool sphere = true;                // true for sources without a normal
  Rgb amount{0};  // irradiance of a surface that faces it; finite ones at distance 1

  // Returns the irradiance of a surface that faces the source, as a share of the amount.
  // `outgoing`: unit direction from the source.
  double strength(const Vec<D>& outgoing, double distance) const {
    if (infinite) return 1;
    double factor = 1 / spread<D>(distance);
    if (!sphere) {
      const double cosine = outgoing.dot(normal);
      factor *= both_sides ? std::abs(cosine) : std::max(0.0, cosine);
    }
    return cone ? factor * cone->share(outgoing) : factor;
  }
  // True if both light the same points in the same way, whatever their amounts.
  bool same_ways(const LightSource& other) const {
    return infinite == other.infinite && both_sides == other.both_sides && sphere == other.sphere &&
           position == other.position && direction == other.direction && normal == other.normal &&
           cone == other.cone;
  }
};

}  // namespace leaflight
