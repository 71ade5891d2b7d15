// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/plan/settings.h"
#include "scene/scene.h"

namespace leaflight {

// About how many bytes a bake in passes takes at most, besides the arrays of the volume
// (math/large_array.h).
std::uint64_t light_memory(const Scene<3>& scene, const BakeSettings<3>& settings);

// The finest texels for which that is at most `bytes`; zeros where it is with those that the bake
// takes by itself. Throws Error where not even the coarsest fit.
Index<3> fitting_resolution(const Scene<3>& scene, const BakeSettings<3>& settings,
                            std::uint64_t bytes);

}  // namespace leaflight
