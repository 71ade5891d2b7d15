// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "bake/driver/pass_texels.h"
#include "bake/indirect/previous_light.h"

namespace leaflight {

// Returns the texels of all volumes of a bake in passes.
template <int D>
std::vector<BakeTexels<D>> texels_of(const LitScene<D>& scene, Texels kind);

// Returns the kind of texels of a previous bake, or none if they are wide or those of a first
// picture. Throws Error if it is a bake of something else.
template <int D>
std::optional<Texels> previous_texels(const LitScene<D>& scene,
                                      const std::vector<PreviousLight<D>>& previous);

}  // namespace leaflight
