// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "surface/marching_cubes.h"

namespace leaflight {

// Returns the mesh with the wanted edges split in two; `wanted` receives the vertices of each. Both
// triangles of an edge are split, so there are no cracks, and a manifold remains one. New vertices
// are last, on the isosurface next to the midpoints of their edges. They have normals if the others
// do. `wanted` is called from several threads. The result does not depend on their number.
IsosurfaceMesh split_edges(const Field<3>& field, double isovalue, const IsosurfaceMesh& mesh,
                           const std::function<bool(std::int32_t, std::int32_t)>& wanted);

}  // namespace leaflight
