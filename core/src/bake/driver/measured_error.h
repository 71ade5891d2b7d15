// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/path_light.h"
#include "bake/driver/texel_light.h"
#include "bake/plan/shared_parts.h"
#include "bake/texels/area_points.h"

namespace leaflight {

// The error of bakes of a scene, compared with path tracing at some points of the isosurfaces. Each
// point has several independent estimates of its radiance. Their variance gives the noise of their
// mean, which is subtracted from the error. Few estimates suffice; more reduce the uncertainty.
template <int D>
class MeasuredError {
 public:
  // Upper bound on the estimates per point; the variance needs at least two.
  static constexpr int most_estimates = 8;
  static constexpr std::size_t most_points = 1 << 16;

  // `texels`: those of the bake, for each volume.
  MeasuredError(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels);
  // The same points of one volume, in a worker.
  MeasuredError(const LitScene<D>& scene, const std::vector<AreaPoint<D>>& points);

  // Traces paths until each point has `estimates` estimates. `texels`: as above.
  void trace(const std::vector<BakeTexels<D>>& texels, int estimates);
  // Lets workers trace the rest of all estimates, which take_shared() waits for.
  void share(const Workers& workers);
  void take_shared();
  // Traces a part of one estimate, and returns its radiances.
  std::string traced(const BakePart& part) const;

  // Adds the error of the fronts of a bake's isosurfaces to its noise.
  void add_to(IsovalueErrors& errors, const std::vector<RadianceGrid<D>>& grids) const;

 private:
  struct Point {
    AreaPoint<D> at;
    std::vector<Rgb> radiance;  // independent estimates
  };

  void place(std::size_t volume, const TexelLattice<D>& texels);
  std::uint64_t seed_of(int estimate) const;
  // Returns one estimate at points [begin, end) of a volume; NaN where no isosurface passes.
  std::vector<Rgb> estimates(const PathLight<D>& light, std::uint64_t seed, std::size_t volume,
                             std::size_t begin, std::size_t end) const;
  void add(std::size_t volume, std::size_t first, const std::vector<Rgb>& radiances);

  const LitScene<D>& scene_;
  int estimates_ = 0;                       // per point, so far
  std::vector<std::vector<Point>> points_;  // of each volume
  SharedParts shared_;
};

}  // namespace leaflight
