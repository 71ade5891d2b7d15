// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "leaflight/field/field.h"

namespace leaflight {

// Texels at regular points of the field's domain, the first and last on its border. Only those are
// active that a leaf of the window can reach: the others are never stored nor sampled.
struct TexelLattice {
  static constexpr std::int32_t inactive = -1;

  Index<3> resolution{};
  Vec3 voxels_per_texel;
  std::vector<std::uint32_t> active;  // linear texel numbers, ascending, axis 0 fastest
  std::vector<std::int32_t> slot;     // per texel: its place in `active`, or inactive

  std::size_t texels() const { return slot.size(); }
  std::size_t linear(const Index<3>& texel) const {
    return (static_cast<std::size_t>(texel[2]) * resolution[1] + texel[1]) * resolution[0] +
           texel[0];
  }
  Index<3> texel(std::uint32_t linear) const;
  // Slot of the texel nearest to an index position of the field, or inactive.
  std::int32_t nearest_slot(const Vec3& index_position) const;
};

// The resolution with `longest` texels along the longest axis and the field's proportions.
Index<3> proportional_resolution(const Field<3>& field, int longest);

// A texel is active if, somewhere within one texel of it, h takes a value of [low, high] on a
// crossing. Throws Error when the lattice would not fit in memory.
TexelLattice make_lattice(const Field<3>& field, const Index<3>& resolution, double low,
                          double high);

// Up to eight slots around an index position with their trilinear weights, renormalised over the
// active texels; all weights are zero if none is active.
struct TexelWeights {
  std::array<std::int32_t, 8> slot;
  std::array<float, 8> weight;
};
TexelWeights trilinear_weights(const TexelLattice& lattice, const Vec3& index_position);

}  // namespace leaflight
