// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/texels/line_volume.h"

namespace leaflight {

// The neighbors of texels, `reach` texels away along some axes.
template <int D>
class TexelNeighbors {
 public:
  TexelNeighbors(const IndexedLattice<D>& texels, int reach) : texels_(texels), reach_(reach) {
    Index<D> low, high;
    low.fill(-1);
    high.fill(2);
    for_each_index<D>(low, high, [&](const Index<D>& step) {
      Neighbor one{step, 0, 1, 1};
      for (int a = D; a-- > 0;) {
        one.offset = one.offset * texels.lattice.resolution[a] + step[a] * reach;
        one.weight *= step[a] != 0 ? beside : 1;
        one.binomial *= step[a] != 0 ? 0.25f : 0.5f;
      }
      if (one.weight < 1) all_.push_back(one);
    });
  }

  // Calls visit(slot, weight) for each active neighbor of a texel.
  template <class Visit>
  void for_each(std::size_t slot, Visit visit) const {
    const Place place(*this, slot);
    for (const Neighbor& one : all_) {
      const std::int32_t s = place.slot(one);
      if (s != TexelLattice<D>::inactive) visit(static_cast<std::size_t>(s), one.weight);
    }
  }

  // Calls visit(slot, slot, weight) for each pair of opposite neighbors that are both active.
  // Weights are binomial: 1/4, 1/2, 1/4 along each axis.
  template <class Visit>
  void for_each_pair(std::size_t slot, Visit visit) const {
    const Place place(*this, slot);
    for (std::size_t i = 0, last = all_.size() - 1; i < all_.size() / 2; ++i) {
      const std::int32_t a = place.slot(all_[i]), b = place.slot(all_[last - i]);
      if (a == TexelLattice<D>::inactive || b == TexelLattice<D>::inactive) continue;
      visit(static_cast<std::size_t>(a), static_cast<std::size_t>(b), all_[i].binomial);
    }
  }

 private:
  // Weight of a neighbor one step away along one axis, relative to the texel itself.
  static constexpr float beside = 0.6f;

  struct Neighbor {
    Index<D> step;
    std::ptrdiff_t offset;
    float weight, binomial;
  };
  // A texel whose neighbors are visited.
  struct Place {
    const TexelNeighbors& neighbors;
    std::uint32_t number;
    int layer;  // of the slot; neighbors are in the same one
    Index<D> texel;
    bool is_within = true;  // true if no neighbor is outside the lattice

    Place(const TexelNeighbors& all, std::size_t slot) : neighbors(all) {
      const TexelLattice<D>& lattice = all.texels_.lattice;
      number = lattice.active[slot];
      layer = lattice.layer(slot);
      texel = lattice.texel(number);
      for (int a = 0; a < D; ++a) {
        is_within =
            is_within && texel[a] >= all.reach_ && texel[a] + all.reach_ < lattice.resolution[a];
      }
    }
    std::int32_t slot(const Neighbor& one) const {
      if (!is_within && is_outside(one.step)) return TexelLattice<D>::inactive;
      if (layer >= 0) return neighbors.texels_.lattice.layer_slot(number + one.offset, layer);
      return neighbors.texels_.slots[number + one.offset];
    }
    bool is_outside(const Index<D>& step) const {
      for (int a = 0; a < D; ++a) {
        const int n = texel[a] + step[a] * neighbors.reach_;
        if (n < 0 || n >= neighbors.texels_.lattice.resolution[a]) return true;
      }
      return false;
    }
  };

  const IndexedLattice<D>& texels_;
  int reach_;
  std::vector<Neighbor> all_;
};

}  // namespace leaflight
