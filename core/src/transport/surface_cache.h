// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <optional>

#include "math/progress.h"
#include "scene/isovalue_nodes.h"
#include "transport/flux_accumulator.h"
#include "transport/photon_tracer.h"

namespace leaflight {

// Radiance of the walls over (u, v, c): each triangle is cut into n x n equal patches, each
// segment of the plane into n, and c has nodes. Each side is kept that anything in the scene can
// see; the outside of a closed box is not. It answers rays of the final gather.
template <int D>
class SurfaceCache {
 public:
  // Without `photons` none can be deposited: it holds what another cache has finished.
  SurfaceCache(const SceneTracer<D>& tracer, bool caustics, double photon_flux,
               std::uint64_t photons, bool fine);

  // Photons that did not come straight from a light: direct light is sampled by finish().
  void deposit(const PhotonHit<D>& photon);

  // The finished radiance, to or from another cache of the same scene; of no other use is a cache
  // then than to answer rays.
  std::vector<Rgb>& finished() { return radiance_; }

  std::size_t entries() const { return radiance_.size(); }
  // Each is a side of a patch with an entry for every node.
  std::size_t columns() const { return entries() / IsovalueNodes::count; }
  // Before columns are finished. `smooth`: photons are spread over patches and then given up, so
  // that indirect_irradiance() is 0.
  void collect_photons(bool smooth, Progress& progress);
  // Turns the photons of one column into radiance and adds direct light by `samples` shadow rays,
  // each of which serves all nodes.
  void finish(std::size_t column, const LightSampler<D>& lights, int samples, std::uint64_t seed,
              std::uint64_t& rays);

  // Of the side that a ray of the given direction hits. `u` uniform in [0,1) chooses between two
  // nodes, so that the mean is linear in c at the cost of one lookup.
  Rgb radiance(const WallHit& hit, const Vec<D>& direction, double c, double u) const;
  // Of the patch that a ray hits: the side of a square of its size.
  double patch_width(const WallHit& hit) const {
    const double area = facets_[first_facet_[hit.mesh] + hit.facet].patch_area;
    return D == 3 ? std::sqrt(area) : area;
  }
  // Light of mirrors and glass, which no path from here finds.
  bool holds_caustics() const { return !caustic_.empty(); }
  // Irradiance from photons at a point of the walls, linear in c.
  Rgb indirect_irradiance(const SurfacePoint<D>& point) const {
    return between_nodes(indirect_sides_, point);
  }
  Rgb caustic_irradiance(const SurfacePoint<D>& point) const {
    return between_nodes(caustic_, point);
  }

 private:
  struct Facet {
    int mesh, facet;
    int cuts;          // patches along each edge
    bool front, back;  // sides that are kept
    std::size_t first_patch, first_entry;
    double patch_area;
    Vec<D> normal;

    int sides() const { return front + back; }
  };
  struct Place {
    const Facet& facet;
    int patch;
    bool front;
    int node;
  };
  // The first entry of the side that a ray of the given direction hits, that of the first node.
  std::optional<std::size_t> column(const WallHit& hit, const Vec<D>& direction) const;
  Place place_of(std::size_t entry) const;
  Rgb between_nodes(const FluxAccumulator& flux, const SurfacePoint<D>& point) const;
  Rgb density(const FluxAccumulator& flux, std::size_t entry) const;
  double share_of_range(int node) const;

  const SceneTracer<D>& tracer_;
  std::vector<std::size_t> first_facet_;  // of each mesh, in facets_
  std::vector<Facet> facets_;
  IsovalueNodes nodes_;
  std::vector<Rgb> radiance_;  // of each facet: patch, side, node
  FluxAccumulator indirect_sides_, caustic_;
};

}  // namespace leaflight
