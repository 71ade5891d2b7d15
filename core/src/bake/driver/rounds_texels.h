// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/swept_bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// How fine a bake in rounds knows light: at the resolution of the settings, or as fine as its
// volume needs and its size allows.
template <int D>
struct RoundsResolutions {
  Index<D> shown, soft, photons;  // as in SweptTexels
  int spacing;
};
template <int D>
RoundsResolutions<D> rounds_resolutions(const Field<D>& field, const IsovalueWindow& window,
                                        const BakeSettings<D>& settings);

// Where it does, by lines or by rays.
template <int D>
SweptTexels<D> rounds_texels(const SweptVolume<D>& volume, const BakeSettings<D>& settings);
template <int D>
SweptTexels<D> ray_texels(const SweptVolume<D>& volume, const BakeSettings<D>& settings);

// Where its first picture does; resolution: of the texels of the result.
template <int D>
SweptTexels<D> preview_texels(const SweptVolume<D>& volume, const Index<D>& resolution);

}  // namespace leaflight
