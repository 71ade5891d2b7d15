// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "leaflight/field/texel_lattice.h"
#include "leaflight/transport/luminaire_sampling.h"

namespace leaflight {

// The number of the texel nearest to a position in texels.
template <int D>
std::size_t nearest_texel(const TexelLattice<D>& lattice, const Vec<D>& position) {
  Index<D> texel;
  for (int a = 0; a < D; ++a) {
    texel[a] = std::clamp(static_cast<int>(position[a] + 0.5), 0, lattice.resolution[a] - 1);
  }
  return lattice.linear(texel);
}

// Shadows of all leaves at once: for some sources of light, the greatest value of the field on the
// way from the source to each texel. A leaf throws a shadow there if it is not above that value. So
// direct light is known at any point of any leaf, not only as the mean over the leaves through a
// texel, which lets the light of a thin shell's bright face shine through it.
template <int D>
class LeafShadows {
 public:
  // `window`: the values that matter; the resolution is that of the lattice.
  LeafShadows(const TexelLattice<D>& lattice, const IsovalueWindow& window)
      : lattice_(&lattice), window_(window) {}

  // Adds a source; its shadows are to be filled in by set().
  void add(const LightSource<D>& source) {
    sources_.push_back(source);
    greatest_.emplace_back(lattice_->texels(), std::uint8_t{0});
  }
  void set(std::int64_t texel, double greatest) { greatest_.back()[texel] = code(greatest); }

  const TexelLattice<D>& lattice() const { return *lattice_; }
  std::size_t sources() const { return sources_.size(); }
  const LightSource<D>& source(std::size_t k) const { return sources_[k]; }
  // Whether the leaf of value h is in the shadow of itself at a position, in texels.
  bool shadowed(std::size_t k, const Vec<D>& position, double h) const {
    return greatest_[k][nearest_texel(*lattice_, position)] >= code(h);
  }

 private:
  // 0: below the window.
  std::uint8_t code(double h) const {
    const double share = (h - window_.min) / window_.height();
    return static_cast<std::uint8_t>(std::clamp(std::ceil(share * 254), 0.0, 254.0));
  }

  const TexelLattice<D>* lattice_;
  IsovalueWindow window_;
  std::vector<LightSource<D>> sources_;
  std::vector<std::vector<std::uint8_t>> greatest_;
};

}  // namespace leaflight
