// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scene/scene.h"

namespace leaflight {

// The distribution of samples of the radiance. A sample at x lies on the isosurface c = h(x).
//   uniform     at random over the domain (thesis 3.4.1 and 4.5)
//   stratified  one at random in each cell of a grid with the domain's proportions (thesis 4.7)
//   importance  more in data cells whose values span more of the isovalue range (thesis Eq. 4.12)
//   level_set   uniform over the isosurfaces of a few isovalues (thesis 3.4.1)
//   letters     inside the letters B, A, D, without the domain's bottom: the thesis's bad example
//               in 2D, extruded along z in 3D
//   slabs       inside five thin diagonal slabs: the thesis's bad example in 3D
//   regular     at the center of each cell of the grid of `stratified`
enum class SampleStrategy { uniform, stratified, importance, level_set, letters, slabs, regular };

// Returns the strategy of a name. Throws Error, with the choices, for an unknown name.
SampleStrategy sample_strategy_from(const std::string& name);
std::string name_of(SampleStrategy strategy);

struct SampleSettings {
  SampleStrategy strategy = SampleStrategy::stratified;
  std::size_t samples = 1'000'000;
  // for level_set: the number of adaptive isovalues, or isovalues in data units
  std::variant<int, std::vector<double>> isovalues = 9;
  std::uint64_t seed = 0;
};

// Returns index positions of the samples, all on isosurfaces of the isovalue range. They depend
// only on the settings. Uniform samples replace those of strata without isosurfaces of the isovalue
// range, and those that a grid leaves over; `regular` has fewer instead. Throws Error for invalid
// settings and if hardly any of the domain is in the isovalue range.
template <int D>
std::vector<Vec<D>> sample_positions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                     const SampleSettings& settings);

}  // namespace leaflight
