// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/transport/flux_accumulator.h"
#include "leaflight/transport/photon_tracer.h"

namespace leaflight {

// Radiance of the surroundings over (u, v, c): each triangle is cut into n x n equal patches, each
// segment of the plane into n, the isovalue window into bins, and both sides are kept. It answers
// rays of the final gather.
template <int D>
class SurfaceCache {
 public:
  SurfaceCache(const SceneTracer<D>& tracer, double photon_flux, std::uint64_t photons);

  // Indirect photons only: direct light is added by add_direct.
  void deposit(const PhotonHit<D>& photon);

  std::size_t entries() const { return radiance_.size(); }
  // Turns the photons of one entry into radiance and adds direct light by `samples` shadow rays.
  void finish(std::size_t entry, const LightSampler<D>& lights, int samples, std::uint64_t seed,
              std::uint64_t& rays);

  Rgb radiance(const SurroundingsHit& hit, const Vec<D>& direction, double isovalue) const;

 private:
  struct Facet {
    int mesh, facet;
    int cuts;           // patches along each edge
    std::size_t first;  // its first patch
    double patch_area;
    Vec<D> normal;
  };
  std::size_t entry(const SurroundingsHit& hit, const Vec<D>& direction, double isovalue) const;

  const SceneTracer<D>& tracer_;
  std::vector<std::size_t> first_facet_;  // of each mesh, in facets_
  std::vector<Facet> facets_;
  std::vector<Rgb> radiance_;  // patch, side, isovalue bin
  FluxAccumulator flux_;
};

}  // namespace leaflight
