// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/sampling.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// A direction from which a lamp may light a point.
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

// A point of a lamp, or a direction of light from infinity, that represents the lamp. It lights the
// whole scene, unlike a LightSample, which is chosen for one lit point.
template <int D>
struct LightSource {
  bool infinite = false;
  bool both_sides = false;  // true if the lamp emits on both sides of its normal
  Vec<D> position{0.0};     // finite only
  Vec<D> direction{0.0};    // infinite only: unit, away from the light
  Vec<D> normal{0.0};       // finite only
  std::optional<typename PointLight<D>::Cone> cone;  // limits the light
  bool sphere = true;                                // true for sources without a normal
  Rgb amount{0};  // irradiance of a surface that faces it; finite ones at distance 1

  // Returns the share of the light inside the cone for a unit direction; 1 without a cone.
  double cone_share(const Vec<D>& outgoing) const;
  // Returns the irradiance of a surface that faces the source, as a share of the amount.
  // `outgoing`: unit direction from the source.
  double strength(const Vec<D>& outgoing, double distance) const;
};

// Returns the power, averaged over the channels. In this and the next functions, lights and
// positions are in the frame, `bounds` contains the scene, and `u` is uniform in [0,1)^2.
template <int D>
double power_of(const Light<D>& light, const BoundingSphere<D>& bounds);

// Returns the largest channel of the flux of any photon that emit_from() returns.
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

// Returns the radiance of the light along a ray of unit direction up to t_max, which may be
// infinite.
template <int D>
Rgb radiance_along(const Light<D>& light, const Vec<D>& origin, const Vec<D>& direction,
                   double t_max);

// Samples the origin of a parallel photon, on a disc as large as the bounds and outside them.
template <int D>
Vec<D> parallel_origin(const BoundingSphere<D>& bounds, const Vec<D>& direction,
                       const std::array<double, 2>& u);
// Returns the area of that disc, or its length in 2D.
template <int D>
double parallel_area(const BoundingSphere<D>& bounds);

}  // namespace leaflight
