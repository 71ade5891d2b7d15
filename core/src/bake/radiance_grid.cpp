// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/radiance_grid.h"

#include <cmath>

namespace leaflight {

template <int D>
Vec<3, float> lookup(const TexelLattice<D>& lattice, const std::vector<Vec<3, float>>& values,
                     const Vec<D>& index_position) {
  const TexelWeights<D> weights = linear_weights(lattice, index_position);
  Vec<3, float> radiance(0);
  for (int i = 0; i < (1 << D); ++i) {
    if (weights.weight[i] > 0) radiance += values[weights.slot[i]] * weights.weight[i];
  }
  return radiance;
}

template <int D>
float lookup_error(const TexelLattice<D>& lattice, const std::vector<float>& errors,
                   const Vec<D>& index_position) {
  const TexelWeights<D> weights = linear_weights(lattice, index_position);
  float variance = 0;
  for (int i = 0; i < (1 << D); ++i) {
    if (!(weights.weight[i] > 0)) continue;
    const float error = errors[weights.slot[i]] * weights.weight[i];
    variance += error * error;
  }
  return std::sqrt(variance);
}

template Vec<3, float> lookup<2>(const TexelLattice<2>&, const std::vector<Vec<3, float>>&,
                                 const Vec<2>&);
template Vec<3, float> lookup<3>(const TexelLattice<3>&, const std::vector<Vec<3, float>>&,
                                 const Vec<3>&);
template float lookup_error<2>(const TexelLattice<2>&, const std::vector<float>&, const Vec<2>&);
template float lookup_error<3>(const TexelLattice<3>&, const std::vector<float>&, const Vec<3>&);

}  // namespace leaflight
