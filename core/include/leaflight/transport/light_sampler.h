// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/math/random.h"
#include "leaflight/trace/scene_tracer.h"

namespace leaflight {

// A photon as it leaves a light.
struct EmittedPhoton {
  Vec3 origin, direction;  // frame
  Rgb flux;                // of the whole scene, as this photon alone would carry it
};

// Chooses a light with probability proportional to its power, and points and directions on it.
class LightSampler {
 public:
  explicit LightSampler(const SceneTracer& tracer);

  // One-sample estimate of the radiance that a surface point reflects of the lights' direct light;
  // `choice` and `u` uniform in [0,1). Adds the number of rays traced to `rays`.
  Rgb direct_radiance(const SurfacePoint& point, double choice, const std::array<double, 2>& u,
                      std::uint64_t& rays) const;

  EmittedPhoton emit(double choice, const std::array<double, 2>& u_position,
                     const std::array<double, 2>& u_direction) const;

 private:
  struct Choice {
    const RectangleLight* light;
    double probability;
  };
  Choice choose(double u) const;

  const SceneTracer& tracer_;
  std::vector<double> cumulative_;  // of the lights' probabilities
};

}  // namespace leaflight
