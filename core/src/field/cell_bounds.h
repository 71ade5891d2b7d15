// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/collaborative_call_once.h>

#include <limits>

#include "base/index_range.h"
#include "base/large_array.h"
#include "field/child_set.h"
#include "field/voxels.h"

namespace leaflight {

// Bounds that tell rays which cells an isosurface may cross: h in 8 bits, and bounds over bricks of
// 4^D, 16^D, 64^D cells. A brick has 4^D children, cells or smaller bricks. All are compared with
// an isovalue at once.
template <int D>
struct CellBounds {
  static constexpr int log2_side = 2, side = 1 << log2_side;
  static constexpr std::uint8_t masked = 255;  // a voxel without data

  // The voxels at the corners of 4^D cells, in steps from the field's least value, rounded down.
  // Axis 0 is fastest. Voxels beyond the domain repeat the last ones.
  static constexpr int row = side + 1;
  struct alignas(16) Cells {
    std::array<std::uint8_t, D == 2 ? 32 : 128> steps;
  };
  // Bounds over bricks of the next finer level, axis 0 fastest; low > high outside the domain.
  struct alignas(16) Bricks {
    std::array<std::uint8_t, 1 << (log2_side * D)> low, high;
  };
  // The slab between two planes that contains a brick's isosurface. h(x) - gradient . x is between
  // low and high, for x in index coordinates. It is infinite if a test would not pay off.
  struct Slab {
    std::array<float, D> gradient{};
    float low = -std::numeric_limits<float>::infinity();
    float high = std::numeric_limits<float>::infinity();
  };

  // Level 0 has bricks of cells, levels 1 and 2 bricks of bricks. Cells and bricks are in the order
  // of dims[level].
  static constexpr int levels = 3;
  std::array<Index<D>, levels> dims;
  LargeArray<Cells> cells;
  std::array<LargeArray<Bricks>, levels - 1> bricks;  // [level - 1]
  std::array<LargeArray<Slab>, levels> slabs;

  double min = 0, per_unit = 1;
  bool is_exact = false;  // true if h = min + steps at each voxel

  double steps_at(double h) const { return (h - min) * per_unit; }

  // The least step at which a voxel may be above an isovalue, and the step below which it may be
  // below.
  struct Limits {
    std::uint8_t may_be_above, may_be_below;
  };
  // Returns the limits for an isovalue with min < isovalue <= max of the field.
  Limits limits(double isovalue) const;
};

// Computes bounds of finite or NaN values in the range min < max.
template <int D>
CellBounds<D> bound_cells(const Voxels& values, const Index<D>& dims, float min, float max);

// Bounds that the first ray computes.
template <int D>
struct CellBoundsOnce {
  tbb::collaborative_once_flag flag;
  CellBounds<D> bounds;
};

}  // namespace leaflight
