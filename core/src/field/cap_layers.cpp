// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/cap_layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "base/index_range.h"
#include "field/shading_gradient.h"

namespace leaflight {
namespace {

// Longest way from the center of a texel to the plane of its layer, in texels.
constexpr double longest_way = 1;

// True if the cut has lowered a voxel within one texel of a texel.
template <int D>
bool touches_cut(const Field<D>& field, const TexelLattice<D>& lattice, std::uint32_t number) {
  const Index<D> texel = lattice.texel(number);
  Index<D> first, last;
  for (int a = 0; a < D; ++a) {
    const double step = lattice.voxels_per_texel[a];
    first[a] = std::max(0, static_cast<int>(std::floor((texel[a] - 1) * step)));
    last[a] = std::min(field.dims[a], static_cast<int>(std::ceil((texel[a] + 1) * step)) + 1);
  }
  bool found = false;
  for_each_index<D>(first, last, [&](const Index<D>& voxel) {
    found = found || is_lowered(field, field.offset(voxel));
  });
  return found;
}

// True if some of the texels have layers. Most have none, even in a volume with a cut.
template <int D>
bool reads_layers(const TexelLattice<D>& lattice, const TexelWeights<D>& texels) {
  if (!lattice.has_layers()) return false;
  return std::any_of(texels.slot.begin(), texels.slot.begin() + texels.count, [&](std::int32_t s) {
    return lattice.capped[lattice.active[s]] != TexelLattice<D>::inactive;
  });
}

}  // namespace

template <int D>
void add_cap_layers(const Field<D>& field, double low, double high, TexelLattice<D>& lattice) {
  if (field.ramp == nullptr || !(low < high)) return;
  std::vector<std::uint8_t> touches(lattice.active.size());
  tbb::parallel_for(std::size_t{0}, touches.size(), [&](std::size_t s) {
    touches[s] = touches_cut(field, lattice, lattice.active[s]);
  });
  std::vector<std::uint32_t> numbers;
  for (std::size_t s = 0; s < touches.size(); ++s) {
    if (touches[s]) numbers.push_back(lattice.active[s]);
  }
  lattice.add_layers(numbers, low, high);
}

template <int D>
TexelWeights<D> layer_weights(const TexelLattice<D>& lattice, const TexelWeights<D>& texels,
                              double value) {
  if (!lattice.has_layers()) return texels;
  const double place = std::clamp((value - lattice.lowest_layer) / lattice.layer_step - 0.5, 0.0,
                                  lattice.layers - 1.0);
  const int below = std::min(static_cast<int>(place), lattice.layers - 2);
  const auto above = static_cast<float>(place - below);
  TexelWeights<D> found;
  float sum = 0;
  for (int i = 0; i < texels.count; ++i) {
    const std::int32_t first = lattice.layer_slot(lattice.active[texels.slot[i]], below);
    if (first == TexelLattice<D>::inactive) continue;
    found.slot[found.count] = first;
    found.weight[found.count++] = texels.weight[i] * (1 - above);
    found.slot[found.count] = first + 1;
    found.weight[found.count++] = texels.weight[i] * above;
    sum += texels.weight[i];
  }
  if (found.count == 0) return texels;
  for (int i = 0; i < found.count; ++i) found.weight[i] /= sum;
  return found;
}

template <int D>
TexelWeights<D> surface_weights(const Field<D>& field, const TexelLattice<D>& lattice,
                                const Vec<D>& index_position) {
  const TexelWeights<D> texels = linear_weights(lattice, index_position);
  if (!reads_layers(lattice, texels)) return texels;
  const double isovalue = cap_isovalue(field, locate(field, index_position));
  return std::isnan(isovalue) ? texels : layer_weights(lattice, texels, isovalue);
}

template <int D>
Vec<D> slot_position(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot) {
  const Vec<D> center = lattice.center(lattice.active[slot]);
  const int layer = lattice.layer(slot);
  if (layer < 0) return center;
  const Vec<D> moved = on_ramp(field, center, lattice.layer_value(layer));
  const Vec<D> way = (moved - center) / lattice.voxels_per_texel;
  return way.length() <= longest_way ? moved : center;
}

template <int D>
double slot_value(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot) {
  const int layer = lattice.layer(slot);
  if (layer >= 0) return lattice.layer_value(layer);
  const CellPoint<D> at = locate(field, lattice.center(lattice.active[slot]));
  return interpolate(load_corners(field, at.cell), at.local);
}

template <int D>
Vec<D> slot_gradient(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot,
                     const Vec<D>& index_position) {
  const CellPoint<D> at = locate(field, index_position);
  if (!lattice.has_layers()) return shading_gradient(field, at);
  if (lattice.layer(slot) >= 0) return ramp_gradient(field, at);
  const bool is_capped = lattice.capped[lattice.active[slot]] != TexelLattice<D>::inactive;
  return is_capped ? uncut_gradient(field, at) : shading_gradient(field, at);
}

template void add_cap_layers<2>(const Field<2>&, double, double, TexelLattice<2>&);
template void add_cap_layers<3>(const Field<3>&, double, double, TexelLattice<3>&);
template TexelWeights<2> layer_weights<2>(const TexelLattice<2>&, const TexelWeights<2>&, double);
template TexelWeights<3> layer_weights<3>(const TexelLattice<3>&, const TexelWeights<3>&, double);
template TexelWeights<2> surface_weights<2>(const Field<2>&, const TexelLattice<2>&, const Vec<2>&);
template TexelWeights<3> surface_weights<3>(const Field<3>&, const TexelLattice<3>&, const Vec<3>&);
template Vec<2> slot_position<2>(const Field<2>&, const TexelLattice<2>&, std::size_t);
template Vec<3> slot_position<3>(const Field<3>&, const TexelLattice<3>&, std::size_t);
template double slot_value<2>(const Field<2>&, const TexelLattice<2>&, std::size_t);
template double slot_value<3>(const Field<3>&, const TexelLattice<3>&, std::size_t);
template Vec<2> slot_gradient<2>(const Field<2>&, const TexelLattice<2>&, std::size_t,
                                 const Vec<2>&);
template Vec<3> slot_gradient<3>(const Field<3>&, const TexelLattice<3>&, std::size_t,
                                 const Vec<3>&);

}  // namespace leaflight
