// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/field.h"

namespace leaflight {

// Interpolates central differences of the shading values between the voxels, in index coordinates.
// They are one-sided at the border of the domain and next to masked voxels. Used for the cosine in
// shading and for the normals of meshes. On a cut it is the gradient of the ramp.
template <int D>
Vec<D> shading_gradient(const Field<D>& field, const CellPoint<D>& point);

// Returns the outward unit shading normal in world space of the isosurface through an index
// position, or zero if there is none.
template <int D>
Vec<D> shading_normal(const Field<D>& field, const Vec<D>& index_position);

// True if a cut has lowered the value of a voxel to that of the ramp, except for its rounding.
template <int D>
bool is_lowered(const Field<D>& field, std::size_t voxel);

// True if a point of an isosurface lies on a cut: some voxels around it are lowered, and all others
// are inside the isosurface.
template <int D>
bool is_on_cut(const Field<D>& field, const CellPoint<D>& point, double isovalue);

// Returns the isovalue of the cap through a point, or NaN if it lies on none. The ramp decides, for
// meshes are moved to its plane; in a dent the interpolant does.
template <int D>
double cap_isovalue(const Field<D>& field, const CellPoint<D>& point);

// Returns the gradient of the ramp of a field that has one, on faces of cells the mean of the cells
// there. Gradients of cells differ where two faces of a cut meet.
template <int D>
Vec<D> ramp_gradient(const Field<D>& field, const CellPoint<D>& point);

// Returns the shading gradient of the voxels that no cut has lowered, or zero if there are none.
template <int D>
Vec<D> uncut_gradient(const Field<D>& field, const CellPoint<D>& point);

// Moves a point along the gradient of the ramp to where the ramp has a value.
template <int D>
Vec<D> on_ramp(const Field<D>& field, const Vec<D>& index_position, double isovalue);

// Moves a point of an isosurface to the plane of a cut if it should lie there. At voxels inside the
// cut the data may be lower than the ramp. The interpolant is then lower, too, and has dents.
template <int D>
Vec<D> flat_on_cut(const Field<D>& field, const Vec<D>& index_position, double isovalue);

}  // namespace leaflight
