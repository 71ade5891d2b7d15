// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "bake/plan/plan.h"
#include "field/texel_lattice.h"
#include "thesis/fixed_settings.h"

namespace leaflight {

// The texels of each volume's isosurfaces. Throws Error where there are none, and no walls to
// light either.
template <int D>
std::vector<TexelLattice<D>> texels_to_bake(const Scene<D>& scene, const FixedSettings<D>& settings,
                                            const Plan& plan);

// Samples scattered over the volumes, and how they are interpolated into texels.
template <int D>
struct ScatteredSamples {
  std::vector<std::vector<Vec<D>>> positions;  // index coordinates, per volume
  ScatteredSettings filter;
};

// Nothing where the settings ask for samples in each texel.
template <int D>
std::optional<ScatteredSamples<D>> scattered_samples(const Scene<D>& scene,
                                                     const FixedSettings<D>& settings);

}  // namespace leaflight
