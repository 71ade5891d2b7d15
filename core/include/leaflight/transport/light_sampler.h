// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/math/random.h"
#include "leaflight/trace/scene_tracer.h"

namespace leaflight {

// A photon as it leaves a light.
template <int D>
struct EmittedPhoton {
  Vec<D> origin, direction;  // frame
  Rgb flux;                  // of the whole scene, as this photon alone would carry it
};

// Chooses a light with probability proportional to its power, and points and directions on it.
template <int D>
class LightSampler {
 public:
  explicit LightSampler(const SceneTracer<D>& tracer);

  // One-sample estimate of the radiance that a surface point reflects of the lights' direct light;
  // `choice` and `u` uniform in [0,1). Adds the number of rays traced to `rays`.
  Rgb direct_radiance(const SurfacePoint<D>& point, double choice, const std::array<double, 2>& u,
                      std::uint64_t& rays) const;

  EmittedPhoton<D> emit(double choice, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;

  // The largest channel of the flux of any emitted photon.
  double largest_flux() const;

 private:
  struct Choice {
    const RectangleLight<D>* light;
    double probability;
  };
  Choice chosen(std::size_t light) const;
  Choice choose(double u) const;
  static Rgb photon_flux(const Choice& choice);

  const SceneTracer<D>& tracer_;
  std::vector<double> cumulative_;  // of the lights' probabilities
};

}  // namespace leaflight
