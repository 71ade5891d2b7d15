// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "field/field.h"
#include "math/ranked_set.h"

namespace leaflight {

// Texels at regular points of the field's domain, the first and last on its border. Only those are
// active that an isosurface of the isovalue range can reach: the others are never stored nor
// sampled.
template <int D>
struct TexelLattice {
  static constexpr std::int32_t inactive = RankedSet::absent;

  Index<D> resolution{};
  Vec<D> voxels_per_texel;
  std::vector<std::uint32_t> active;  // linear texel numbers, ascending, axis 0 fastest
  RankedSet slot;                     // of a texel: its place in `active`, or inactive

  std::size_t texels() const { return slot.bound(); }
  // Ascending texel numbers.
  void activate(std::vector<std::uint32_t> numbers);
  std::size_t linear(const Index<D>& texel) const { return linear_number<D>(texel, resolution); }
  Index<D> texel(std::size_t linear) const { return index_of<D>(linear, resolution); }
  // Index position of the field at which a texel lies.
  Vec<D> centre(std::uint32_t linear) const {
    return to_vector<D>(texel(linear)) * voxels_per_texel;
  }
  // The cell between texels that holds an index position, clamped to the domain.
  CellPoint<D> cell_point(const Vec<D>& index_position) const;
  // The texel nearest to a position in texels.
  Index<D> nearest_texel(const Vec<D>& position) const {
    Index<D> texel;
    for (int a = 0; a < D; ++a) {
      texel[a] = std::clamp(static_cast<int>(position[a] + 0.5), 0, resolution[a] - 1);
    }
    return texel;
  }
  // Slot of the texel nearest to an index position of the field, or inactive.
  std::int32_t nearest_slot(const Vec<D>& index_position) const {
    return slot[linear(nearest_texel(index_position / voxels_per_texel))];
  }
};

// Slot of the active texel nearest to an index position of the field, or inactive if there is none
// within three texels along each axis.
template <int D>
std::int32_t nearest_active_slot(const TexelLattice<D>& lattice, const Vec<D>& index_position);

// Of a lattice with texels `width` times as wide, and with texels half as wide.
template <int D>
Index<D> coarser_resolution(Index<D> resolution, int width) {
  for (int& n : resolution) n = std::max(2, (n - 1 + width - 1) / width + 1);
  return resolution;
}
template <int D>
Index<D> finer_resolution(Index<D> resolution) {
  for (int& n : resolution) n = 2 * n - 1;
  return resolution;
}

// A lattice over a field of the given dimensions of which no texel is active.
template <int D>
TexelLattice<D> inactive_lattice(const Index<D>& dims, const Index<D>& resolution);

// Throws Error for a resolution that no lattice can have, whatever the memory.
template <int D>
void check_resolution(const Index<D>& resolution);

// A texel is active if, somewhere within one texel of it, h takes a value of [low, high] on a
// crossing; `considered`: and if the texel of this number is among those. Throws Error when the
// lattice would not fit in memory.
template <int D>
TexelLattice<D> make_lattice(const Field<D>& field, const Index<D>& resolution, double low,
                             double high, const std::vector<bool>* considered = nullptr);

// How many of its texels would be active.
template <int D>
std::size_t active_texels(const Field<D>& field, const Index<D>& resolution, double low,
                          double high);

// The slots of the active texels around an index position, with their (bi-, tri-)linear weights,
// renormalised over them. Those without weight are left out: on an edge of the grid six of eight,
// where texels are as wide as voxels.
template <int D>
struct TexelWeights {
  int count = 0;
  std::array<std::int32_t, 1 << D> slot;
  std::array<float, 1 << D> weight;
};
template <int D>
TexelWeights<D> linear_weights(const TexelLattice<D>& lattice, const Vec<D>& index_position);

// Of all texels, those that lookups at some index positions may use.
template <int D>
std::vector<bool> texels_around(const Index<D>& dims, const Index<D>& resolution,
                                const std::vector<Vec<D>>& index_positions);

}  // namespace leaflight
