// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "bake/direct/all_shadows.h"
#include "transport/light_points.h"

namespace leaflight {

// How the visibility maps of a volume are computed. `back`: true for maps of both sides, which
// requires that the scene has only this volume. For `spacing`, see VisibilitySweep.
template <int D>
struct MapSettings {
  Index<D> resolution{};
  bool back = false;
  double spacing = 1;
};

// Returns the texels of the maps of a volume.
template <int D>
TexelLattice<D> map_lattice(const Scene<D>& scene, int volume, const Index<D>& resolution);

// The codes of some light points, one side: [slot * points + point].
using PointCodes = std::vector<std::uint8_t>;

// Computes visibility maps of one volume, a few light points at a time. The inputs must outlive it.
template <int D>
class MapSweeps {
 public:
  // Number of points whose maps are computed at once.
  static constexpr std::size_t points_at_once = 8;
  // Work per texel and point, in the unit of the progress: points of lines.
  static constexpr double work_of_texel = 0.2;

  // `lattice`: of the maps. `margin_of`: texels whose width sets the margin of the codes.
  MapSweeps(const SceneTracer<D>& tracer, int volume, const std::vector<LightPoint<D>>& points,
            const TexelLattice<D>& lattice, const TexelLattice<D>& margin_of, double spacing);

  // Returns the range of the codes in values of the field.
  IsovalueRange code_range() const;
  // Returns the codes of the points with these numbers, at most points_at_once. The first call
  // prepares the sweeps.
  PointCodes codes(const std::vector<std::size_t>& numbers, bool back, Progress& progress);

 private:
  const SceneTracer<D>& tracer_;
  int volume_;
  const std::vector<LightPoint<D>>& points_;
  const TexelLattice<D>& lattice_;
  double spacing_;
  IsovalueRange code_range_;  // in common isovalues
  std::optional<AllShadows<D>> shadows_;
};

}  // namespace leaflight
