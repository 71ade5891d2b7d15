// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/photon_caches.h"
#include "bake/texels/point_sampler.h"
#include "thesis/texels_to_bake.h"

namespace leaflight {

// The inputs that the passes of a bake with fixed samples share, and the light that they compute.
template <int D>
struct FixedBake {
  const SceneTracer<D>& tracer;
  const LightSampler<D>& lights;
  const FixedSettings<D>& settings;
  const Plan& plan;
  Progress& progress;
  std::vector<TexelLattice<D>> lattices;         // per volume
  std::optional<ScatteredSamples<D>> scattered;  // nothing: samples in each texel
  PhotonCaches<D> photons{};
  std::vector<IsosurfaceRadiance<D>> isosurfaces{};  // per volume; after direct light

  int sides() const { return plan.back ? 2 : 1; }
  PointSampler<D> sampler() const {
    return {lights, isosurfaces, photons.walls.get(), plan.caustics};
  }
  // Returns the average rays of a sample of indirect light.
  double indirect_rays() const {
    return plan.indirect ? traits_of(settings.estimator).rays_per_sample : 0;
  }
};

// The texels on one side of a volume's isosurfaces.
template <int D>
struct IsosurfaceTexels {
  int volume;
  bool back;
  const TexelLattice<D>& lattice;
};

}  // namespace leaflight
