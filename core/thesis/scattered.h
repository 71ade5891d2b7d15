// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "field/texel_lattice.h"

namespace leaflight {

// The filter, with the weight of a sample at a distance of d texels (thesis 3.4.2). shepard: d^-5
// (Eq. 3.11). tent: 1 - d / (radius + 1/2). box: 1.
enum class ScatteredFilter { shepard, tent, box };

// Returns the filter of a name. Throws Error for an unknown name.
ScatteredFilter scattered_filter_from(const std::string& name);

struct ScatteredSettings {
  ScatteredFilter filter = ScatteredFilter::shepard;
  // Largest difference in each coordinate between a texel and the texel nearest to a sample that
  // reaches it (thesis 4.4).
  int radius = 3;
};

// The result per active texel, in the order of `active`.
struct ScatteredTexels {
  std::vector<Rgb> value;
  std::vector<float> error;          // standard error of the mean over the channels
  std::vector<std::uint32_t> count;  // samples that reached the texel; 0: filled from others
};

// Interpolates scattered data: each active texel gets the weighted mean of the samples that reach
// it. `positions`: index coordinates of the field, one per value. Texels without samples get the
// mean of the nearest texels with samples, so there are no holes. Wide filters are for gaps.
// Shepard's filter with a radius above 8 uses only the 64 samples nearest to a texel, which have
// nearly all of the weight. So it costs the same for any radius. The tent and the box are limited
// to 32. The result does not depend on the number of threads. Throws Error for invalid settings and
// if there are no samples.
template <int D>
ScatteredTexels interpolate_scattered(const TexelLattice<D>& lattice,
                                      const std::vector<Vec<D>>& positions,
                                      const std::vector<Rgb>& values,
                                      const ScatteredSettings& settings, Progress& progress);

}  // namespace leaflight
