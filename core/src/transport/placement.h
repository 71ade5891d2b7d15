// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// Finds errors of a scene that need rays. A mesh may enclose a light although the volumes are
// outside it. A volume may be outside the walls, where no light reaches it. Throws Error with one
// sentence that names the object.
template <int D>
void check_placement(const SceneTracer<D>& tracer);

}  // namespace leaflight
