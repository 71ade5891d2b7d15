// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "base/affine.h"
#include "base/box.h"
#include "field/cell_bounds.h"
#include "field/interval_pyramid.h"
#include "field/voxels.h"

namespace leaflight {

// A scalar grid h with voxel i at index_to_world(i), interpolated trilinearly (bilinearly in 2D). A
// cell with a NaN at a corner is masked: h is undefined there and no isosurface passes.
template <int D>
struct Field {
  std::shared_ptr<const void> owner;  // owner of the values
  Voxels values;
  // Values for the shading gradient: `values`, or smoothed values that are NaN at the same voxels.
  Voxels shading_values;
  std::shared_ptr<const void> shading_owner;
  // Values of a ramp through plane cuts of the volume, linear in the distance, or null. Each value
  // of a voxel is at most that of the ramp.
  const float* ramp = nullptr;
  std::shared_ptr<const void> ramp_owner;
  double ramp_step = 0;  // of the ramp, a voxel
  Index<D> dims{};
  Affine<D> index_to_world;
  Affine<D> world_to_index;
  float min = 0;
  float max = 0;
  bool masked = false;
  std::shared_ptr<const IntervalPyramid<D>> pyramid;
  std::shared_ptr<CellBoundsOnce<D>> cell_bounds_once;

  bool has_smooth_normals() const { return shading_values != values; }
  const CellBounds<D>& cell_bounds() const {
    CellBoundsOnce<D>& once = *cell_bounds_once;
    tbb::collaborative_call_once(once.flag,
                                 [&] { once.bounds = bound_cells<D>(values, dims, min, max); });
    return once.bounds;
  }
  std::size_t offset(const Index<D>& voxel) const { return linear_number<D>(voxel, dims); }
  std::size_t voxels() const { return cell_count<D>(dims); }
  float value(const Index<D>& voxel) const { return value_at(values, offset(voxel)); }
};

// Makes a field and its interval pyramid. Checks the values: at least two voxels along each axis,
// finite or NaN, not constant. Checks that the transform is invertible. `owner` keeps `values`
// alive.
template <int D>
Field<D> make_field(const Voxels& values, const Index<D>& dims, const Affine<D>& index_to_world,
                    std::shared_ptr<const void> owner);

// Returns the field at another place. Both share their values and the bounds of cells. Checks the
// transform.
template <int D>
Field<D> placed(const Field<D>& field, const Affine<D>& index_to_world);

// A point of the domain: a cell and the local coordinates in [0,1]^D.
template <int D>
struct CellPoint {
  Index<D> cell{};
  Vec<D> local{0.0};

  Vec<D> index_position() const { return to_vector<D>(cell) + local; }
};

// Returns the cell point of an index position, clamped to the domain.
template <int D>
CellPoint<D> locate(const Field<D>& field, const Vec<D>& index_position);

// Returns the corners of the domain in world coordinates.
template <int D>
std::vector<Vec<D>> world_corners(const Field<D>& field);

// Returns the axis-aligned box of the voxels in world coordinates.
template <int D>
Box<D> world_box(const Field<D>& field);

template <int D>
bool inside(const Field<D>& field, const Vec<D>& index_position) {
  for (int a = 0; a < D; ++a) {
    if (!(index_position[a] >= 0 && index_position[a] <= field.dims[a] - 1)) return false;
  }
  return true;
}

// The values at the corners of a cell; bit a of a corner's number is its offset along axis a.
template <int D>
struct CellCorners {
  std::array<double, 1 << D> h;
};

template <int D>
CellCorners<D> load_corners(const Field<D>& field, const Index<D>& cell) {
  CellCorners<D> corners;
  const std::size_t first = field.offset(cell), row = field.dims[0], slice = row * field.dims[1];
  std::visit(
      [&](const auto* values) {
        for (int edge = 0; edge < 1 << (D - 1); ++edge) {
          const auto* h = values + first + (edge & 1) * row + (edge >> 1) * slice;
          corners.h[2 * edge] = h[0];
          corners.h[2 * edge + 1] = h[1];
        }
      },
      field.values);
  return corners;
}

// Interpolates in a cell; returns NaN in a masked cell.
template <int D>
double interpolate(const CellCorners<D>& corners, const Vec<D>& local);

// Interpolates at an index position; returns NaN in masked cells and outside the field.
template <int D>
double value_at(const Field<D>& field, const Vec<D>& index_position);

// Returns the derivative of the trilinear interpolant in index coordinates, which is normal to the
// traced surface. It is discontinuous at the faces of cells.
template <int D>
Vec<D> geometric_gradient(const CellCorners<D>& corners, const Vec<D>& local);

}  // namespace leaflight
