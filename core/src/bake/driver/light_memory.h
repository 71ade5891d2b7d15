// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/plan/settings.h"
#include "scene/scene.h"

namespace leaflight {

// Estimates the maximum memory of a bake in passes in bytes, without the arrays of the volume
// (base/large_array.h).
std::uint64_t light_memory(const Scene<3>& scene, const BakeSettings<3>& settings);

// Returns the finest resolution whose light_memory() is at most `bytes`, or zeros if the default
// resolution fits. Throws Error if not even the coarsest resolution fits.
Index<3> fitting_resolution(const Scene<3>& scene, const BakeSettings<3>& settings,
                            std::uint64_t bytes);

}  // namespace leaflight
