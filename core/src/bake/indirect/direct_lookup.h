// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <vector>

#include "bake/direct/direct_light.h"
#include "bake/texels/line_volume.h"

namespace leaflight {

// Direct light on the fronts of white isosurfaces at the texels of a lattice, of a few light points
// that stand for all. Lines look it up where they hit an isosurface. A texel stores the greatest
// value on the way to each point, which decides which of the isosurfaces through it lie in shadow:
// light of a thin shell's bright face does not leak through it.
template <int D>
class DirectLookup {
 public:
  static constexpr int most_sources = 8;
  static constexpr std::size_t bytes_a_texel = most_sources * sizeof(std::uint32_t);

  DirectLookup() = default;
  DirectLookup(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
               const DirectLight<D>& direct, Progress& progress);

  std::size_t sources() const { return amounts_.size(); }

  void prefetch(std::size_t source, std::int32_t slot) const {
    if (source < reflected_.size()) __builtin_prefetch(&reflected_[source][slot]);
  }
  // What the front of the isosurface of value h reflects in the texel of a slot, if this source is
  // all light; the mean over the sources counts.
  Rgb reflected(std::size_t source, std::int32_t slot, double h) const {
    const std::uint32_t packed = reflected_[source][slot];
    if (!(static_cast<float>(packed & 0xff) < code_(h))) return Rgb(0);
    const std::uint32_t bits = packed & ~0xffu;
    float share;
    std::memcpy(&share, &bits, sizeof share);
    return amounts_[source] * static_cast<Real>(share);
  }

 private:
  VisibilityCode code_;
  std::vector<Rgb> amounts_;  // of the sources
  // Of each source and slot, without its shadow, as a share of the source's amount: a float, whose
  // last 8 bits are the greatest value on the way.
  std::vector<std::vector<std::uint32_t>> reflected_;
};

}  // namespace leaflight
