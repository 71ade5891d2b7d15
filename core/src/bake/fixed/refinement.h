// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bake/output/radiance_grid.h"
#include "scene/scene.h"

namespace leaflight {

// The share of a grid's cells, those with eight texels about them, that finer texels serve. Of a
// scan's error that texels of half the width everywhere take away, the fifth of the cells where
// light varies most holds all (docs/decisions/2026-11-21-finer-texels.md).
inline constexpr double refined_share = 0.2;

// For each cell of the grid's finest lattice, whether finer texels are to serve it: the share of
// them where colours, radiance times exposure up to 1, vary most among the cell's texels beyond
// their noise, times the area of all leaves in the cell. `window` is of the field's values.
template <int D>
std::vector<bool> cells_to_refine(const Field<D>& field, const IsovalueWindow& window,
                                  const RadianceGrid<D>& grid, double exposure);

// Texels of half the width for some cells of a lattice.
template <int D>
struct FinerTexels {
  TexelLattice<D> all;
  // Those of them that no other cell touches. The rest take what is interpolated there, so that
  // radiance is continuous.
  TexelLattice<D> sampled;
};
template <int D>
FinerTexels<D> finer_texels(const Field<D>& field, const IsovalueWindow& window,
                            const RadianceGrid<D>& grid, const std::vector<bool>& cells);

// The level of all these texels, from the radiance of those that were sampled and of the levels
// before.
template <int D>
RadianceLevel<D> finer_level(const RadianceGrid<D>& coarse, FinerTexels<D> texels,
                             const RadianceLevel<D>& sampled);

}  // namespace leaflight
