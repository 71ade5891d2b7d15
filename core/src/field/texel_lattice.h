// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/ranked_set.h"
#include "field/field.h"

namespace leaflight {

// Texels at regular points of the field's domain, the first and last on its border. Texels are
// active if an isosurface of the isovalue range can reach them; the others are never stored or
// sampled. Each has a slot in the arrays of a bake. Texels on a capped cut have a slot more for
// each layer (cap_layers.h).
template <int D>
struct TexelLattice {
  static constexpr std::int32_t inactive = RankedSet::absent;
  static constexpr int layers = 8;

  Index<D> resolution{};
  Vec<D> voxels_per_texel;
  // The texel of each slot, by its number, axis 0 fastest. The first `active_texels` are those of
  // the active texels, ascending; those of layers follow.
  std::vector<std::uint32_t> active;
  std::size_t active_texels = 0;
  RankedSet slot;                           // of a texel: its index in `active`, or inactive
  RankedSet capped;                         // texels with layers; empty: none
  double lowest_layer = 0, layer_step = 1;  // lowest value of the first layer, and their step

  std::size_t texels() const { return slot.bound(); }
  // Activates texels by their numbers, which must be ascending.
  void activate(std::vector<std::uint32_t> numbers);
  void activate(RankedSet numbers) {
    slot = std::move(numbers);
    active = slot.numbers();
    active_texels = active.size();
  }
  // Adds layers to active texels, for values between two.
  void add_layers(const std::vector<std::uint32_t>& numbers, double low, double high);
  void drop_layers() { active.resize(active_texels); }
  bool has_layers() const { return active_texels < active.size(); }
  // Returns the layer of a slot, or -1 for a texel itself.
  int layer(std::size_t s) const {
    return s < active_texels ? -1 : static_cast<int>((s - active_texels) % layers);
  }
  // Returns the lowest value of a layer, and the one in its middle.
  double layer_low(int layer) const { return lowest_layer + layer * layer_step; }
  double layer_value(int layer) const { return layer_low(layer) + 0.5 * layer_step; }
  // Returns the layer of a value, clamped to all layers.
  int layer_of(double value) const {
    return std::clamp(static_cast<int>((value - lowest_layer) / layer_step), 0, layers - 1);
  }
  // Returns the slot of a layer of a texel, or inactive.
  std::int32_t layer_slot(std::size_t number, int layer) const {
    const std::int32_t rank = capped[number];
    if (rank == inactive) return inactive;
    return static_cast<std::int32_t>(active_texels) + rank * layers + layer;
  }
  // Returns the slot of another texel, in the layer of the given slot.
  std::int32_t beside(std::size_t s, std::size_t number) const {
    const int in = layer(s);
    return in < 0 ? slot[number] : layer_slot(number, in);
  }
  std::size_t linear(const Index<D>& texel) const { return linear_number<D>(texel, resolution); }
  Index<D> texel(std::size_t linear) const { return index_of<D>(linear, resolution); }
  // Returns the index position of a texel.
  Vec<D> center(std::uint32_t linear) const {
    return to_vector<D>(texel(linear)) * voxels_per_texel;
  }
  // Returns the cell between texels at an index position, clamped to the domain.
  CellPoint<D> cell_point(const Vec<D>& index_position) const;
  // Returns the texel nearest to a position in texels.
  Index<D> nearest_texel(const Vec<D>& position) const {
    Index<D> texel;
    for (int a = 0; a < D; ++a) {
      texel[a] = std::clamp(static_cast<int>(position[a] + 0.5), 0, resolution[a] - 1);
    }
    return texel;
  }
  // Returns the slot of the texel nearest to an index position, or inactive.
  std::int32_t nearest_slot(const Vec<D>& index_position) const {
    return slot[linear(nearest_texel(index_position / voxels_per_texel))];
  }
};

// Returns the slot of the active texel nearest to an index position, or inactive if there is none
// within three texels along each axis.
template <int D>
std::int32_t nearest_active_slot(const TexelLattice<D>& lattice, const Vec<D>& index_position);

// Returns the resolution with texels `width` times as wide; finer_resolution(): half as wide.
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

// Returns a lattice without active texels. `dims`: voxels of the field.
template <int D>
TexelLattice<D> inactive_lattice(const Index<D>& dims, const Index<D>& resolution);

// Throws Error for an invalid resolution, regardless of memory.
template <int D>
void check_resolution(const Index<D>& resolution);

// Makes a lattice. A texel is active if h crosses a value of [low, high] within one texel of it.
// Throws Error if the lattice does not fit in memory.
template <int D>
TexelLattice<D> make_lattice(const Field<D>& field, const Index<D>& resolution, double low,
                             double high);

// Counts the texels that make_lattice() would activate.
template <int D>
std::size_t active_texels(const Field<D>& field, const Index<D>& resolution, double low,
                          double high);

// The slots of the active texels around an index position, with linear weights that are
// renormalized over them. Texels of weight zero are dropped: six of eight on an edge of the grid,
// if texels are as wide as voxels. On a capped cut, two layers of each texel.
template <int D>
struct TexelWeights {
  int count = 0;
  std::array<std::int32_t, 2 << D> slot;
  std::array<float, 2 << D> weight;
};
template <int D>
TexelWeights<D> linear_weights(const TexelLattice<D>& lattice, const Vec<D>& index_position);

template <int D, class Value>
Value mean(const TexelWeights<D>& near, const std::vector<Value>& values) {
  Value mean(0);
  for (int i = 0; i < near.count; ++i) mean += values[near.slot[i]] * near.weight[i];
  return mean;
}

}  // namespace leaflight
