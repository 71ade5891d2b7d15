// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "lights/area_light.h"
#include "lights/point_light.h"
#include "lights/sun_light.h"

namespace leaflight {

// A lamp. Each type has these functions, by which the core uses it. The first three take positions
// in the world. The others take them in the frame, where the volumes are around the origin. `u` is
// uniform in [0,1)^2, and `bounds` contains the scene.
//
//   name              identifies the lamp in messages.
//   check()           throws Error if the lamp is invalid.
//   corners()         points whose box contains the lamp; none for a lamp at infinity.
//   to_frame()        moves a position p to (p - center) * scale; radiance and irradiance stay.
//   amount()          color that the lamp's strength multiplies; black lamps emit nothing.
//   place()           point in front of the lamp; nothing for a lamp at infinity.
//   power()           power, averaged over the channels, by which photons choose a lamp.
//   largest_flux()    largest channel of the flux of any photon of emit().
//   near_irradiance() rough irradiance at the origin, by which shadow rays choose a lamp.
//   sample()          samples the light at a point.
//   emit()            samples a photon.
//   source()          samples a point of the lamp that stands for all of it.
//   radiance_along()  radiance along a ray of unit direction up to t_max, which may be infinite.
//   width()           width over the distance from the origin; wider lamps have more light points.
//   aspect()          columns over rows of the lattice of light points.
//   light_point()     the source for a position in that lattice.
template <int D>
using Light = std::variant<AreaLight<D>, PointLight<D>, SunLight<D>>;

}  // namespace leaflight
