// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "surface/marching_cubes.h"

namespace leaflight {

// The mesh with those edges cut in two that are wanted, by the vertices of each. What is cut off
// one triangle is cut off its neighbour, too: no cracks, and a manifold remains one. New vertices
// come last, on the isosurface next to the middle of their edge; they have normals if the others
// do. `wanted` is called by several threads at once. The result does not depend on their number.
IsosurfaceMesh split_edges(const Field<3>& field, double isovalue, const IsosurfaceMesh& mesh,
                           const std::function<bool(std::int32_t, std::int32_t)>& wanted);

}  // namespace leaflight
