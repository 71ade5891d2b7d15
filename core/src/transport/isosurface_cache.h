// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/progress.h"
#include "field/texel_lattice.h"
#include "transport/flux_accumulator.h"
#include "transport/photon_tracer.h"

namespace leaflight {

// Photons that a side of the isosurfaces stores. Direct photons are excluded if shadow rays sample
// direct light.
enum class SideContents { nothing, indirect, all };

// Irradiance of the isosurfaces of one volume from photons by the coarea formula
// dV = dA dc / |grad c|:
//   E(R) = sum of F_p over the photons in R / integral of |grad c| over R
// R is a box of texels. The fourth coordinate of a photon is redundant, since c = h(x). So a
// density estimate in space serves all isovalues (docs/theory.md). Caustics, which are sharp, can
// have their own cells with smaller boxes.
template <int D>
class IsosurfaceCache {
 public:
  // `variance`: true if the variances are needed.
  IsosurfaceCache(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& lattice,
                  SideContents back, bool variance, bool caustics, double photon_flux,
                  std::uint64_t photons);

  void deposit(const PhotonHit<D>& photon);

  // Averages the photons over boxes of (2 radius + 1)^D texels and frees the sums. The radius is
  // chosen so that a box contains about a hundred photons.
  void finish(Progress& progress);

  // Returns the irradiance at an active texel from the photons on a side, or zero if the cache
  // stores none.
  Rgb irradiance(std::int32_t slot, bool back) const {
    return indirect(slot, back) + caustic(slot, back);
  }
  Rgb indirect(std::int32_t slot, bool back) const { return value(sides_[back].indirect, slot); }
  Rgb caustic(std::int32_t slot, bool back) const { return value(sides_[back].caustic, slot); }

  // Returns the variance, averaged over the channels, from the number of photons.
  float indirect_variance(std::int32_t slot, bool back) const {
    return variance(sides_[back].indirect, slot);
  }
  float caustic_variance(std::int32_t slot, bool back) const {
    return variance(sides_[back].caustic, slot);
  }

 private:
  // Photons of one kind on one side, and then their irradiance.
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
