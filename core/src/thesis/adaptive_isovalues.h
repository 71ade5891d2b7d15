// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/scene.h"

namespace leaflight {

// `count` isovalues of the isovalue range, ascending, whose isosurfaces lie as close together as
// possible: the greatest distance (world) from a point of the domain to the nearest of them is
// minimal (thesis 3.4.1). The isosurfaces within a distance r of x are those between the least and
// the greatest value in the ball about x, so isovalues reach all points within r if they stab all
// these intervals; the fewest that do are found by taking the intervals by their upper ends, and
// the smallest r for which `count` suffice by bisection.
//
// Nine for the 3D bump box are 3.92 8.93 16.1 22.7 28.4 33.0 36.9 62.5 196, beside the thesis's
// 0.01 6.47 13.2 19.3 24.8 29.6 39.0 56.7 161, found by a method that it only refers to. No point
// is farther than 0.09 of the box's side from ours, 0.17 from the thesis's, 0.38 from nine that are
// equally spaced.
//
// The distances are those between voxels, of which a few dozen per axis are looked at. Throws Error
// when no isosurface of the isovalue range passes through the domain.
template <int D>
std::vector<double> adaptive_isovalues(const Field<D>& field, const IsovalueRange& isovalue_range,
                                       int count);

}  // namespace leaflight
