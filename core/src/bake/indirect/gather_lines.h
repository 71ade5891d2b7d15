// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/indirect/direct_lookup.h"
#include "bake/texels/line_volume.h"
#include "bake/texels/texel_surface.h"
#include "transport/environment_sampler.h"
#include "transport/surface_cache.h"

namespace leaflight {

// Stored light that lines look up where they hit a surface.
template <int D>
struct GatheredRadiance {
  const std::vector<TexelSurface<D>>& surfaces;  // isosurfaces through the texels
  // Indirect light that white isosurfaces reflect at the texels, for fronts and backs; empty: none.
  std::array<const std::vector<Rgb>*, 2> indirect;
  const std::vector<Rgb>* back_direct;  // direct light of the backs; null: none
  const std::vector<Rgb>& texture;      // factor on the albedo of the texels; empty: none
  const DirectLookup<D>& direct;        // of the fronts, at the texels that gather
  const SurfaceCache<D>* walls;         // null: the walls are dark
  // Light without points. mesh_is_wide: true for each mesh that emits such light. sky: null if the
  // environment has none.
  const std::vector<char>& mesh_is_wide;
  const EnvironmentSampler<D>* sky;
  bool emission;  // true if isosurfaces emit light
};

// Gathers light along parallel lines, `spacing` texels apart, in both directions. At each texel on
// a line, adds the light that the isosurface there would reflect if it were white. A ray back from
// a point of value h hits the isosurface of h at the last plane whose value is at least h. On the
// back, the value is at most h. A stack finds these planes for all points of a line ("previous
// greater element"). Returns the number of lines.
template <int D>
std::uint64_t gather_along_lines(const LineVolume<D>& volume, const IndexedLattice<D>& texels,
                                 const GatheredRadiance<D>& from, const Vec<D>& direction,
                                 int spacing, const std::array<double, 2>& offset,
                                 std::uint64_t key, Progress& progress, SideMoments& moments);

}  // namespace leaflight
