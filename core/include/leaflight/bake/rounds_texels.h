// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/settings.h"
#include "leaflight/bake/swept_bake.h"

namespace leaflight {

// Where a bake in rounds knows light: at the resolution of the settings, or as fine as its volume
// needs and its size allows.
template <int D>
SweptTexels<D> rounds_texels(const SweptVolume<D>& volume, const BakeSettings<D>& settings);

// Where its first picture does.
template <int D>
SweptTexels<D> preview_texels(const SweptVolume<D>& volume);

}  // namespace leaflight
