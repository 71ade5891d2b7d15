// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/direct_lookup.h"
#include "bake/texels/line_volume.h"
#include "transport/environment_sampler.h"
#include "transport/surface_cache.h"

namespace leaflight {

// What lines look up where they meet something.
template <int D>
struct GatheredRadiance {
  const IndexedLattice<D>& texels;
  // Indirect light that white isosurfaces reflect, of the texels' front and backs; empty: none.
  std::array<const std::vector<Rgb>*, 2> indirect;
  const std::vector<Rgb>* back_direct;  // radiance of the backs by direct light; empty: none
  const DirectLookup<D>& direct;        // of the fronts, at the texels that gather
  const SurfaceCache<D>* walls;         // null where there are none
  // Light that has no points: whether each mesh emits such, and the environment's; null: none.
  const std::vector<char>& mesh_is_wide;
  const EnvironmentSampler<D>* sky;
};

// Adds to the texels that they cross what white isosurfaces reflect of the light that comes along
// parallel lines, `spacing` texels apart, from the one side or the other. From each point of a line
// the way is followed to where its own isosurface is met: next to the last point before of a value
// as large, or smaller on the back, which a stack finds for all points of the line together
// ("previous greater element"). Returns the number of lines.
template <int D>
std::uint64_t gather_along_lines(const LineVolume<D>& volume, const IndexedLattice<D>& texels,
                                 const GatheredRadiance<D>& from, const Vec<D>& direction,
                                 int spacing, const std::array<double, 2>& offset,
                                 std::uint64_t key, Progress& progress, SideMoments& moments);

}  // namespace leaflight
