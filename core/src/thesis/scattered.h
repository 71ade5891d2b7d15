// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "field/texel_lattice.h"
#include "math/progress.h"

namespace leaflight {

// The weight of a sample at a distance of d texels (thesis 3.4.2): d^-5 (Shepard, Eq. 3.11);
// 1 - d / (radius + 1/2), the tent; 1, the box.
enum class ScatteredFilter { shepard, tent, box };

// Throws Error for an unknown name.
ScatteredFilter scattered_filter_from(const std::string& name);

struct ScatteredSettings {
  ScatteredFilter filter = ScatteredFilter::shepard;
  // A sample reaches the texels whose coordinates differ by no more than this from those of the
  // texel nearest to it (thesis 4.4).
  int radius = 3;
};

// Per active texel, in the order of `active`.
struct ScatteredTexels {
  std::vector<Rgb> value;
  std::vector<float> error;          // standard error of the mean over the channels
  std::vector<std::uint32_t> count;  // samples that reached the texel; 0: filled from others
};

// Scattered data interpolation: the weighted mean, at each active texel, of the samples that reach
// it. `positions` are index coordinates of the field, with a value each. A texel that none reaches
// takes the mean of those nearest to it that have one, so that there are no holes.
//
// Wide filters are for gaps. Shepard's with a radius of more than 8 takes the 64 samples nearest to
// a texel alone, which hold nearly all of the weight, and so costs the same for any radius; the
// tent and the box, of no use there, go no farther than 32. The result does not depend on the
// number of threads. Throws Error for settings that make no sense and when there is no sample.
template <int D>
ScatteredTexels interpolate_scattered(const TexelLattice<D>& lattice,
                                      const std::vector<Vec<D>>& positions,
                                      const std::vector<Rgb>& values,
                                      const ScatteredSettings& settings, Progress& progress);

}  // namespace leaflight
