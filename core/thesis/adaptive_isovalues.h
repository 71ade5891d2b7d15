// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/scene.h"

namespace leaflight {

// Returns `count` isovalues of the isovalue range, ascending, whose isosurfaces are as close
// together as possible. They minimize the greatest distance (world) from a point of the domain to
// the nearest isosurface (thesis 3.4.1). The isosurfaces within a distance r of x have the
// isovalues between the least and the greatest value in the ball around x. So isovalues reach all
// points within r if each of these intervals contains one. A greedy pass over the intervals by
// their upper ends finds the fewest. Bisection finds the smallest r for which `count` suffice.
//
// For the 3D bump box, nine isovalues are 3.92 8.93 16.1 22.7 28.4 33.0 36.9 62.5 196. The thesis
// has 0.01 6.47 13.2 19.3 24.8 29.6 39.0 56.7 161, by a method that it only cites. No point is
// farther than 0.09 of the box's side from ours, 0.17 from the thesis's, and 0.38 from nine that
// are equally spaced.
//
// Distances are between a few dozen voxels per axis. Throws Error if no isosurface of the isovalue
// range passes through the domain.
template <int D>
std::vector<double> adaptive_isovalues(const Field<D>& field, const IsovalueRange& isovalue_range,
                                       int count);

}  // namespace leaflight
