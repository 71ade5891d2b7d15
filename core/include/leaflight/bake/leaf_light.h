// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <vector>

#include "leaflight/bake/swept_volume.h"
#include "leaflight/transport/luminaire_sampling.h"

namespace leaflight {

// Direct light on the outer sides of all leaves at once, as if they were white, of some sources of
// light. For each source and texel it holds the greatest value of the field on the way: a leaf
// throws a shadow there if it is not above that value. So direct light is known at any point of any
// leaf, not only as the mean over the leaves through a texel, which lets the light of a thin
// shell's bright face shine through it.
template <int D>
class LeafLight {
 public:
  // Of so many sources as a bake has of them.
  static constexpr std::size_t bytes_a_texel = 8 * sizeof(std::uint32_t) + 1;

  explicit LeafLight(const SweptVolume<D>& volume, const SweptLattice<D>& texels);

  const TexelLattice<D>& lattice() const { return texels_->lattice; }
  std::size_t sources() const { return sources_.size(); }

  // Adds a source: set_greatest() for the texels that lines come to, then finish().
  void add(const LightSource<D>& source);
  void set_greatest(std::int64_t texel, double greatest) { greatest_[texel] = code(greatest); }
  void finish(Progress& progress);

  void prefetch(std::size_t source, std::size_t texel) const {
    if (source < reflected_.size()) __builtin_prefetch(&reflected_[source][texel]);
  }
  // What the outer side of the leaf of value h reflects in a texel.
  Rgb reflected(std::size_t source, std::size_t texel, double h) const {
    const std::uint32_t packed = reflected_[source][texel];
    if ((packed & 0xff) >= code(h)) return Rgb(0);
    const std::uint32_t bits = packed & ~0xffu;
    float share;
    std::memcpy(&share, &bits, sizeof share);
    return sources_[source].amount * static_cast<Real>(share);
  }

 private:
  // 0: below the window.
  std::uint8_t code(double h) const {
    const double share = (h - window_.min) / window_.height();
    return static_cast<std::uint8_t>(std::clamp(std::ceil(share * 254), 0.0, 254.0));
  }

  SweptVolume<D> volume_;
  const SweptLattice<D>* texels_;
  IsovalueWindow window_;
  std::vector<LightSource<D>> sources_;
  std::vector<std::uint8_t> greatest_;  // of the source that is being added
  // Of each source and texel, without its shadow, as a share of the source's amount: a float, whose
  // last 8 bits are the greatest value on the way.
  std::vector<std::vector<std::uint32_t>> reflected_;
};

}  // namespace leaflight
