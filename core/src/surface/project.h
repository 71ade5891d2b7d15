// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// Returns the nearest point of the isosurface along its gradient, by bracketed search within two
// voxels. Returns the point itself if there is none. All points are in world coordinates.
template <int D>
Vec<D> project_to_isosurface(const Field<D>& field, const Vec<D>& point, double isovalue);

// Returns the nearest point of the isosurface along a direction or against it, in world
// coordinates. The field must fall below the isovalue in that direction, so points outside a thin
// shell do not move to its inner side. Returns the point itself if there is none within `reach`
// voxels. Errs by up to 1e-4 voxels, since it is for the vertices of coarse meshes.
Vec3 project_along(const Field<3>& field, const Vec3& point, const Vec3& outward, double isovalue,
                   double reach);

}  // namespace leaflight
