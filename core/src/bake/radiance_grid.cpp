// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/radiance_grid.h"

#include <cmath>

namespace leaflight {

template <int D>
const RadianceGrid<D>& RadianceGrid<D>::at(const Vec<D>& index_position) const {
  if (!finer) return *this;
  Index<D> middle = lattice.cell_point(index_position).cell;
  for (int& n : middle) n = 2 * n + 1;
  // All leaves through the cell reach the texel in its middle, so that it tells for the cell.
  const TexelLattice<D>& fine = finer->lattice;
  const bool serves = fine.slot[fine.linear(middle)] != TexelLattice<D>::inactive;
  return serves ? finer->at(index_position) : *this;
}

template <int D>
RadianceGrid<D> make_grid(const SideAverages& direct, const SideAverages& indirect) {
  RadianceGrid<D> grid;
  for (std::size_t s = 0; s < direct[0].size(); ++s) {
    const Average &straight = direct[0][s], &rest = indirect[0][s];
    grid.radiance.emplace_back(straight.mean + rest.mean);
    grid.radiance_indirect.emplace_back(rest.mean);
    grid.radiance_error.push_back(std::sqrt(straight.variance + rest.variance));
  }
  for (std::size_t s = 0; s < direct[1].size(); ++s) {
    grid.radiance_back.emplace_back(direct[1][s].mean + indirect[1][s].mean);
  }
  return grid;
}

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

template struct RadianceGrid<2>;
template struct RadianceGrid<3>;
template RadianceGrid<2> make_grid<2>(const SideAverages&, const SideAverages&);
template RadianceGrid<3> make_grid<3>(const SideAverages&, const SideAverages&);
template Vec<3, float> lookup<2>(const TexelLattice<2>&, const std::vector<Vec<3, float>>&,
                                 const Vec<2>&);
template Vec<3, float> lookup<3>(const TexelLattice<3>&, const std::vector<Vec<3, float>>&,
                                 const Vec<3>&);
template float lookup_error<2>(const TexelLattice<2>&, const std::vector<float>&, const Vec<2>&);
template float lookup_error<3>(const TexelLattice<3>&, const std::vector<float>&, const Vec<3>&);

}  // namespace leaflight
