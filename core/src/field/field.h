// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "field/cell_bounds.h"
#include "field/interval_pyramid.h"
#include "field/voxels.h"
#include "math/affine.h"
#include "math/box.h"

namespace leaflight {

// A scalar grid h with voxel i at index_to_world(i), trilinear (bilinear) in between. A cell with a
// NaN at one of its corners is masked: h is undefined there and no isosurface passes.
template <int D>
struct Field {
  std::shared_ptr<const void> owner;  // keeps the values alive
  Voxels values;
  // Those whose gradient is that of shading: `values`, or smoothed ones, NaN where these are.
  Voxels shading_values;
  std::shared_ptr<const void> shading_owner;
  Index<D> dims{};
  Affine<D> index_to_world;
  Affine<D> world_to_index;
  float min = 0;
  float max = 0;
  bool masked = false;
  IntervalPyramid<D> pyramid;
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

// Checks the values (at least two voxels along each axis, finite or NaN, not constant) and the
// transform (invertible), and builds the interval pyramid. `values` must live as long as `owner`.
template <int D>
Field<D> make_field(const Voxels& values, const Index<D>& dims, const Affine<D>& index_to_world,
                    std::shared_ptr<const void> owner);

// A point of the domain: a cell and the coordinates in [0,1]^D within it.
template <int D>
struct CellPoint {
  Index<D> cell{};
  Vec<D> local{0.0};

  Vec<D> index_position() const { return to_vector<D>(cell) + local; }
};

// The cell point of an index position, clamped to the domain.
template <int D>
CellPoint<D> locate(const Field<D>& field, const Vec<D>& index_position);

// The box, parallel to the world's axes, that the voxels fill.
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

// NaN in a masked cell.
template <int D>
double interpolate(const CellCorners<D>& corners, const Vec<D>& local);

// The same at an index position; NaN outside the field, too.
template <int D>
double value_at(const Field<D>& field, const Vec<D>& index_position);

// Derivative of the trilinear interpolant with respect to the index coordinates: the normal of the
// traced surface. It jumps at the faces of cells.
template <int D>
Vec<D> geometric_gradient(const CellCorners<D>& corners, const Vec<D>& local);

// Central differences of the values of shading at the voxels, interpolated between them; in index
// coordinates. They are one-sided at the border of the domain and beside masked voxels. Used for
// the cosine of shading and the normals of meshes.
template <int D>
Vec<D> shading_gradient(const Field<D>& field, const CellPoint<D>& point);

// The outward unit normal in world space with which the isosurface through an index position is
// shaded; zero where there is none.
template <int D>
Vec<D> shading_normal(const Field<D>& field, const Vec<D>& index_position);

}  // namespace leaflight
