// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "bake/plan/plan.h"
#include "field/texel_lattice.h"
#include "thesis/fixed_settings.h"

namespace leaflight {

// Returns the texels of each volume's isosurfaces. Throws Error if there are neither texels nor
// walls to light.
template <int D>
std::vector<TexelLattice<D>> texels_to_bake(const Scene<D>& scene, const FixedSettings<D>& settings,
                                            const Plan& plan);

// Samples scattered over the volumes, and the filter that interpolates them into texels.
template <int D>
struct ScatteredSamples {
  std::vector<std::vector<Vec<D>>> positions;  // index coordinates, per volume
  ScatteredSettings filter;
};

// Returns the scattered samples, or nothing if the settings ask for samples in each texel.
template <int D>
std::optional<ScatteredSamples<D>> scattered_samples(const Scene<D>& scene,
                                                     const FixedSettings<D>& settings);

}  // namespace leaflight
