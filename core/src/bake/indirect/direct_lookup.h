// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <vector>

#include "bake/direct/direct_light.h"
#include "bake/texels/line_volume.h"
#include "base/random.h"

namespace leaflight {

// Direct light on the fronts of white isosurfaces at the texels of a lattice, from a few light
// points that represent all. Lines look it up where they hit an isosurface. A texel stores the
// greatest value on the way to each point. This value decides which isosurfaces in the texel are in
// shadow, so light does not leak through thin shells.
template <int D>
class DirectLookup {
 public:
  static constexpr int most_sources = 8;
  static constexpr std::size_t bytes_a_texel = most_sources * sizeof(std::uint32_t);

  DirectLookup() = default;
  DirectLookup(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
               const DirectLight<D>& direct, Progress& progress);

  std::size_t sources() const { return reflected_.size(); }

  void prefetch(std::size_t source, std::int32_t slot) const {
    if (source < reflected_.size()) __builtin_prefetch(&reflected_[source][slot]);
  }
  // Returns the radiance of the front of isosurface h in a texel, as if this source were all light.
  // Callers average over the sources.
  Rgb reflected(std::size_t source, std::int32_t slot, double h) const {
    const std::uint32_t packed = reflected_[source][slot];
    if (!(static_cast<float>(packed & 0xff) < code_(h))) return Rgb(0);
    const std::uint32_t bits = packed & ~0xffu;
    float share;
    std::memcpy(&share, &bits, sizeof share);
    return amounts_[choice(slot) * sources() + source] * static_cast<Real>(share);
  }

 private:
  // Neighbors differ in their choice of light points, so that no region lacks the light of any.
  static constexpr int most_choices = 64;
  std::size_t choice(std::size_t slot) const {
    return choices_ == 1 ? 0 : Random::mix(slot) % choices_;
  }

  VisibilityCode code_;
  std::size_t choices_ = 1;
  std::vector<Rgb> amounts_;  // by choice of light points, one per source
  // Unshadowed share of the source's amount, by source and slot. It is a float whose last 8 bits
  // hold the greatest value on the way.
  std::vector<std::vector<std::uint32_t>> reflected_;
};

}  // namespace leaflight
