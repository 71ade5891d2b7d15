// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/line_bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// How fine the texels of a bake in passes are: of the resolution of the settings, or as fine as its
// volume needs and its size allows.
template <int D>
struct PassResolutions {
  Index<D> shown, indirect, photons;  // as in BakeTexels
  int spacing;
};
template <int D>
PassResolutions<D> pass_resolutions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                    const BakeSettings<D>& settings);

// Where it does, by lines or by rays, with texels so many times as wide.
template <int D>
BakeTexels<D> pass_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                          int width = 1);
template <int D>
BakeTexels<D> ray_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                         int width = 1);

// Where its first picture does; resolution: of the texels of the result.
template <int D>
BakeTexels<D> preview_texels(const LineVolume<D>& volume, const Index<D>& resolution);

}  // namespace leaflight
