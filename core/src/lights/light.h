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
// Its `name` identifies it in messages. check() throws Error if the lamp is invalid.
// The box of the points of corners() contains the lamp. A lamp at infinity has none.
// The function to_frame() moves a position p to (p - center) * scale. Radiance and irradiance stay.
// The strength of the lamp multiplies the color amount(). Black lamps emit nothing.
// The point place() is in front of the lamp. A lamp at infinity has none.
//
// Photons choose a lamp by power(), the mean over the channels. Then emit() samples a photon.
// No channel of its flux is above largest_flux().
// Shadow rays choose a lamp by near_irradiance(), the rough irradiance at the origin. Then sample()
// samples the light at a point.
// The function source() samples a point of the lamp that stands for all of it.
// The function radiance_along() takes a ray of unit direction up to t_max, which may be infinite.
//
// The lattice of light points has aspect() columns for each row. It has more points if width() is
// larger, the width of the lamp over its distance from the origin.
// The function light_point() returns the source for a position in that lattice.
template <int D>
using Light = std::variant<AreaLight<D>, PointLight<D>, SunLight<D>>;

}  // namespace leaflight
