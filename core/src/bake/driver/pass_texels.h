// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/texel_light.h"
#include "bake/plan/settings.h"

namespace leaflight {

// The texels of a bake.
enum class Texels : int {
  fine,    // at most half a voxel wide, if their number stays small
  usual,   // as wide as the settings say, or else by the size of the volume
  wide,    // twice the usual width
  preview  // for the first picture
};

// The resolutions of a bake in passes. They follow the settings, or else the detail and the size of
// the volume.
template <int D>
struct PassResolutions {
  Index<D> shown, indirect, photons;  // as in BakeTexels
  int spacing;
};
template <int D>
PassResolutions<D> pass_resolutions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                    const BakeSettings<D>& settings, Texels kind);

// Returns the texels of a bake by lines or by rays, but not those of the first picture.
template <int D>
BakeTexels<D> pass_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings,
                          Texels kind = Texels::usual);
template <int D>
BakeTexels<D> ray_texels(const LineVolume<D>& volume, const BakeSettings<D>& settings, Texels kind);

// Returns the texels of the first picture. `resolution`: of the result.
template <int D>
BakeTexels<D> preview_texels(const LineVolume<D>& volume, const Index<D>& resolution);

}  // namespace leaflight
