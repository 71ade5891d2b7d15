// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/line_bake.h"
#include "bake/texels/area_points.h"

namespace leaflight {

// How far bakes of a scene are from the light that paths find at some points of the isosurfaces.
// Each point has several independent estimates of its radiance. Their spread tells how noisy their
// mean is, so that this noise does not count as error: few estimates suffice, more tell more.
template <int D>
class MeasuredError {
 public:
  // Estimates of a point, at most. Fewer than two tell nothing.
  static constexpr int most_estimates = 8;

  // `texels`: of each volume, those of the bake.
  MeasuredError(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels);

  // Traces paths until each point has so many estimates. `texels`: as before.
  void trace(const std::vector<BakeTexels<D>>& texels, int estimates);

  // The error of the fronts of a bake's isosurfaces, to those of its noise.
  void add_to(IsovalueErrors& errors, const std::vector<RadianceGrid<D>>& grids) const;

 private:
  struct Point {
    AreaPoint<D> at;
    std::vector<Rgb> radiance;  // independent estimates
  };

  void place(std::size_t volume, const TexelLattice<D>& texels);

  const LitScene<D>& scene_;
  int estimates_ = 0;                       // of each point, so far
  std::vector<std::vector<Point>> points_;  // of each volume
};

}  // namespace leaflight
