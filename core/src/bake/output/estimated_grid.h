// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/output/radiance_grid.h"

namespace leaflight {

// Estimates the light of a volume whose values have changed since its bake, such as by a cut.
//
// Texels away from the changes keep the light of the bake. Near changes the light of the bake is
// that of isosurfaces which are no longer there, often of dark ones within the volume. Texels there
// get the mean light of the isosurfaces that the lights reach, as a linear function of the normal.
// The error of texels is NaN, because it is not known. With `direct`, texels of the result contain
// direct light; `baked` must then have its radiance. Otherwise the result has indirect light alone.
//
// The field `before` was baked. The field `now` has other values at the same place in the world.
// The result has `resolution` texels. It covers `isovalue_range`, in values of the field.
RadianceGrid<3> estimated_grid(const RadianceGrid<3>& baked, const Field<3>& before,
                               const Field<3>& now, const Index<3>& resolution,
                               const IsovalueRange& isovalue_range, bool direct);

}  // namespace leaflight
