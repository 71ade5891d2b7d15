// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/sampling.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// A direction from which a lamp may light a point.
template <int D>
struct LightSample {
  Vec<D> direction{0.0};  // unit, from the point towards the light
  bool infinite = false;  // the light has no place: sun and environment
  Vec<D> end{0.0};        // the point of the light, and its normal towards the lit point
  Vec<D> end_normal{0.0};
  Rgb radiance{0};  // over the density of the sample per angle; 0: no light comes from there
};

// A photon as it leaves a light.
template <int D>
struct EmittedPhoton {
  Vec<D> origin, direction;  // frame
  Rgb flux;                  // of the whole light, as this photon alone would carry it
};

// One point of a lamp, or one direction of light from afar, that stands for all of it. It
// lights the whole scene, unlike a LightSample, which is chosen for the point that is lit.
template <int D>
struct LightSource {
  bool infinite = false;
  bool both_sides = false;  // the lamp shines on both sides of its normal
  Vec<D> position{0.0};     // finite only
  Vec<D> direction{0.0};    // infinite only: unit, in which the light travels
  Vec<D> normal{0.0};       // finite only
  std::optional<typename PointLight<D>::Cone> cone;  // which limits the light
  bool sphere = true;                                // without a normal
  Rgb amount{0};  // irradiance of a surface that faces the source, at distance 1 unless infinite

  // What the cone leaves of the light in a unit direction; 1 without one.
  double cone_share(const Vec<D>& way) const;
  // The irradiance of a surface that faces the source, reached by it in a unit direction, as a
  // share of the amount.
  double strength(const Vec<D>& way, double distance) const;
};

// What every lamp must answer; lights and positions in the frame, `bounds` about the scene,
// `u` uniform in [0,1)^2.
// Power, averaged over the channels.
template <int D>
double power_of(const Light<D>& light, const BoundingSphere<D>& bounds);

// The largest channel of the flux of any photon that emit() returns.
template <int D>
double largest_flux_of(const Light<D>& light, const BoundingSphere<D>& bounds);

template <int D>
LightSample<D> sample_light(const Light<D>& light, const Vec<D>& from,
                            const std::array<double, 2>& u);

template <int D>
EmittedPhoton<D> emit_from(const Light<D>& light, const BoundingSphere<D>& bounds,
                           const std::array<double, 2>& u_position,
                           const std::array<double, 2>& u_direction);

template <int D>
LightSource<D> source_of(const Light<D>& light, const std::array<double, 2>& u);

// The radiance that a ray of unit direction finds on the light before t_max, which may be infinite.
template <int D>
Rgb radiance_along(const Light<D>& light, const Vec<D>& origin, const Vec<D>& direction,
                   double t_max);

// A photon of parallel light: through a disc as large as the bounds, from outside them.
template <int D>
Vec<D> parallel_origin(const BoundingSphere<D>& bounds, const Vec<D>& direction,
                       const std::array<double, 2>& u);
// The area of that disc; its length in the plane.
template <int D>
double parallel_area(const BoundingSphere<D>& bounds);

}  // namespace leaflight
