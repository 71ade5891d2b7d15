// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/line_bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// The resolutions of a bake in passes. They follow the settings, or else the detail and the size of
// the volume.
template <int D>
struct PassResolutions {
  Index<D> shown, indirect, photons;  // as in BakeTexels
  int spacing;
};
template <int D>
PassResolutions<D> pass_resolutions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                    const BakeSettings<D>& settings);

// Returns the texels of a bake by lines or by rays. `width`: factor on the width of texels.
template <int D>
BakeTexels<D> pass_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                          int width = 1);
template <int D>
BakeTexels<D> ray_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                         int width = 1);

// Returns the texels of the first picture. `resolution`: of the result.
template <int D>
BakeTexels<D> preview_texels(const LineVolume<D>& volume, const Index<D>& resolution);

}  // namespace leaflight
