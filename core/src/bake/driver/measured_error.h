// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/line_bake.h"
#include "bake/texels/area_points.h"

namespace leaflight {

// How far bakes of a scene are from the light that paths find at some points of the isosurfaces.
// Each point has several independent estimates of its radiance. Their spread tells how noisy their
// mean is, so that this noise does not count as error.
template <int D>
class MeasuredError {
 public:
  // `texels`: of each volume, those of the bake.
  MeasuredError(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels);

  // The error of the fronts of a bake's isosurfaces, to those of its noise.
  void add_to(IsovalueErrors& errors, const std::vector<RadianceGrid<D>>& grids) const;

 private:
  // At a point, independent of each other.
  static constexpr int estimates = 8;
  struct Point {
    AreaPoint<D> at;
    std::array<Rgb, static_cast<std::size_t>(estimates)> radiance;
  };

  void place(std::size_t volume, const TexelLattice<D>& texels);
  void trace(const std::vector<BakeTexels<D>>& texels);

  const LitScene<D>& scene_;
  std::vector<std::vector<Point>> points_;  // of each volume
};

}  // namespace leaflight
