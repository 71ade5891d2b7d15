// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// Finds errors of a scene that need rays: a light that a mesh encloses although the volumes are
// outside it, and a volume outside the walls that no light reaches. Throws Error with one sentence
// that names the object.
template <int D>
void check_placement(const SceneTracer<D>& tracer);

}  // namespace leaflight
