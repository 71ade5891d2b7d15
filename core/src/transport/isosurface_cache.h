// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/texel_lattice.h"
#include "math/progress.h"
#include "transport/flux_accumulator.h"
#include "transport/photon_tracer.h"

namespace leaflight {

// Which photons a side of the isosurfaces keeps. Where direct light is known better, from shadow
// rays, direct photons are left out.
enum class SideContents { nothing, indirect, all };

// Irradiance of the isosurfaces of one volume from photons by the coarea formula dV = dA dc / |grad
// c|:
//   E(R) = sum of F_p over the photons in R / integral of |grad c| over R
// with R a box of texels. The fourth coordinate of a photon carries no information, since c = h(x),
// so a plain density estimate in space serves all isovalues (docs/theory.md). Caustics, which are
// sharp, have cells of their own and are smoothed less, if asked for.
template <int D>
class IsosurfaceCache {
 public:
  // `indirect_variance`: whether that will be asked for.
  IsosurfaceCache(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& lattice,
                  SideContents back, bool indirect_variance, bool caustics, double photon_flux,
                  std::uint64_t photons);

  void deposit(const PhotonHit<D>& photon);

  // Smooths the photons over boxes of (2 radius + 1)^D texels, the radius chosen so that a box
  // holds about a hundred of them, and frees the sums.
  void finish(Progress& progress);

  // Irradiance at an active texel from the photons that the side keeps; zero where it keeps none.
  Rgb irradiance(std::int32_t slot, bool back) const {
    return indirect(slot, back) + caustic(slot, back);
  }
  Rgb indirect(std::int32_t slot, bool back) const { return value(sides_[back].indirect, slot); }
  Rgb caustic(std::int32_t slot, bool back) const { return value(sides_[back].caustic, slot); }

  // Variances of these, of the mean over the colours, from the number of photons.
  float indirect_variance(std::int32_t slot, bool back) const {
    return variance(sides_[back].indirect, slot);
  }
  float caustic_variance(std::int32_t slot, bool back) const {
    return variance(sides_[back].caustic, slot);
  }

 private:
  // Photons of one kind on one side, then their irradiance.
  struct Density {
    FluxAccumulator flux{0, 1, 1};
    std::atomic<std::uint64_t> stored{0};
    std::vector<Rgb> irradiance;
    std::vector<float> variance;
  };
  struct Side {
    SideContents contents = SideContents::nothing;
    Density indirect, caustic;
  };
  static Rgb value(const Density& density, std::int32_t slot) {
    return density.irradiance.empty() ? Rgb(0) : density.irradiance[slot];
  }
  static float variance(const Density& density, std::int32_t slot) {
    return density.variance.empty() ? 0 : density.variance[slot];
  }
  void estimate(Density& density, int radius, const std::vector<float>& measure,
                Progress& progress);
  int radius_for(double photons, std::size_t texels, double photons_per_box, int largest) const;

  const SceneTracer<D>& tracer_;
  const int volume_;
  const TexelLattice<D>& lattice_;
  std::array<Side, 2> sides_;  // front, back
};

}  // namespace leaflight
