// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.h"

namespace leaflight {

// True if an isosurface of a range of common isovalues is open. It then ends at the border of the
// domain or at a masked cell, where light can reach its inside.
template <int D>
bool isosurfaces_are_open(const Volume<D>& volume, const IsovalueRange& isovalue_range);

}  // namespace leaflight
