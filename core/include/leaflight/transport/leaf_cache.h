// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/field/texel_lattice.h"
#include "leaflight/math/progress.h"
#include "leaflight/transport/flux_accumulator.h"
#include "leaflight/transport/photon_tracer.h"

namespace leaflight {

// Irradiance of leaves from photons by the coarea formula dV = dA dc / |grad h|:
//   E(R) = sum of F_p over the photons in R / integral of |grad h| over R
// with R a box of texels. The fourth coordinate of a photon carries no information, since c = h(x),
// so a plain density estimate in space serves all isovalues (docs/theory.md). The outer side keeps
// indirect photons only, as its direct light is known better; the inner side keeps all.
template <int D>
class LeafCache {
 public:
  LeafCache(const SceneTracer<D>& tracer, const TexelLattice<D>& lattice, bool inner_side,
            double photon_flux, std::uint64_t photons);

  void deposit(const PhotonHit<D>& photon);

  // Smooths the photons over boxes of (2 radius + 1)^D texels, the radius chosen so that a box
  // holds about a hundred of them, and frees the sums.
  void finish(Progress& progress);

  // Irradiance from indirect photons on the outer side of an active texel.
  const Rgb& outer_indirect(std::int32_t slot) const { return outer_[slot]; }
  // Irradiance from all photons on the inner side; zero where that side is not kept.
  Rgb inner(std::int32_t slot) const { return inner_.empty() ? Rgb(0) : inner_[slot]; }

 private:
  const SceneTracer<D>& tracer_;
  const TexelLattice<D>& lattice_;
  FluxAccumulator outer_flux_, inner_flux_;
  std::atomic<std::uint64_t> stored_{0};
  std::vector<Rgb> outer_, inner_;
};

}  // namespace leaflight
