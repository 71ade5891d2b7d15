// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <optional>

#include "base/progress.h"
#include "scene/isovalue_nodes.h"
#include "transport/flux_accumulator.h"
#include "transport/photon_tracer.h"

namespace leaflight {

// Radiance of the walls over (u, v, c), for final-gather rays. Each triangle is divided into n x n
// equal patches, each segment into n; c has nodes. It stores each side that the rest of the scene
// can see; the outside of a closed box is not stored.
template <int D>
class SurfaceCache {
 public:
  // Without `photons`, none can be deposited; then it only holds the radiance of another cache.
  SurfaceCache(const SceneTracer<D>& tracer, bool caustics, double photon_flux,
               std::uint64_t photons, bool fine);

  // Deposits a photon, unless it came straight from a light: finish() samples direct light.
  void deposit(const PhotonHit<D>& photon);

  // Returns the finished radiance, for transfers between caches of the same scene. Afterwards a
  // cache only serves lookups.
  std::vector<Rgb>& finished() { return radiance_; }

  std::size_t entries() const { return radiance_.size(); }
  // Returns the number of columns; a column has the entries of one side of a patch for all nodes.
  std::size_t columns() const { return entries() / IsovalueNodes::count; }
  // Prepares the photons before columns are finished. `smooth`: averages photons over patches and
  // then frees them, so that indirect_irradiance() is 0.
  void collect_photons(bool smooth, Progress& progress);
  // Converts the photons of one column to radiance and adds direct light by `samples` shadow rays,
  // each of which serves all nodes.
  void finish(std::size_t column, const LightSampler<D>& lights, int samples, std::uint64_t seed,
              std::uint64_t& rays);

  // Returns the radiance of the side that a ray hits. The number `u`, uniform in [0,1), chooses one
  // of two nodes. So the mean is linear in c with a single lookup.
  Rgb radiance(const MeshHit& hit, const Vec<D>& direction, double c, double u) const;
  // Returns the side of a square with the area of the patch that a ray hits.
  double patch_width(const MeshHit& hit) const {
    const double area = facets_[first_facet_[hit.mesh] + hit.facet].patch_area;
    return D == 3 ? std::sqrt(area) : area;
  }
  // True if it holds light of mirrors and glass, which paths from here cannot find.
  bool holds_caustics() const { return !caustic_.empty(); }
  // Returns the irradiance from photons at a point on a wall, linearly in c.
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
    bool front, back;  // stored sides
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
  // Returns the number of the first entry, that of the first node, of the column that a ray hits;
  // nothing for a side that is not stored.
  std::optional<std::size_t> column(const MeshHit& hit, const Vec<D>& direction) const;
  Place place_of(std::size_t entry) const;
  Rgb between_nodes(const FluxAccumulator& flux, const SurfacePoint<D>& point) const;
  Rgb density(const FluxAccumulator& flux, std::size_t entry) const;
  double share_of_range(int node) const;

  const SceneTracer<D>& tracer_;
  std::vector<std::size_t> first_facet_;  // number in facets_, one per mesh
  std::vector<Facet> facets_;
  IsovalueNodes nodes_;
  std::vector<Rgb> radiance_;  // by facet, patch, side, node
  FluxAccumulator indirect_sides_, caustic_;
};

}  // namespace leaflight
