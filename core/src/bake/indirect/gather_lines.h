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
  const std::vector<TexelSurface<D>>& surfaces;  // the isosurfaces through the texels
  // Indirect light that white isosurfaces reflect, of the texels' front and backs; empty: none.
  std::array<const std::vector<Rgb>*, 2> indirect;
  const std::vector<Rgb>* back_direct;  // radiance of the backs by direct light; null: none
  const DirectLookup<D>& direct;        // of the fronts, at the texels that gather
  const SurfaceCache<D>* walls;         // null: they are dark
  // Light that has no points: whether each mesh emits such, and the environment's; null: none.
  const std::vector<char>& mesh_is_wide;
  const EnvironmentSampler<D>* sky;
  bool emission;  // whether isosurfaces emit theirs
};

// Gathers light along parallel lines, `spacing` texels apart, in both senses. At each texel that a
// line crosses it adds the light that the isosurface there would reflect if it were white. A ray
// back along the line from a point of value h hits the isosurface of h at the last plane before
// whose value is at least h (on the back: at most h). A stack finds these planes for all points of
// a line together ("previous greater element"). Returns the number of lines.
template <int D>
std::uint64_t gather_along_lines(const LineVolume<D>& volume, const IndexedLattice<D>& texels,
                                 const GatheredRadiance<D>& from, const Vec<D>& direction,
                                 int spacing, const std::array<double, 2>& offset,
                                 std::uint64_t key, Progress& progress, SideMoments& moments);

}  // namespace leaflight
