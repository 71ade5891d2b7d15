// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/collaborative_call_once.h>

#include <limits>

#include "field/child_set.h"
#include "field/voxels.h"
#include "math/index_range.h"
#include "math/large_array.h"

namespace leaflight {

// Where an isosurface may pass, for rays: h in 8 bits, and its bounds over bricks of 4^D, 16^D,
// 64^D cells. A brick has 4^D children, cells or smaller bricks, all of which are compared with an
// isovalue at once.
template <int D>
struct CellBounds {
  static constexpr int log2_side = 2, side = 1 << log2_side;
  static constexpr std::uint8_t masked = 255;  // a voxel without data

  // The voxels at the corners of 4^D cells, in steps from the field's least value, rounded down.
  // Axis 0 fastest; beyond the domain its last voxels are repeated.
  static constexpr int row = side + 1;
  struct alignas(16) Cells {
    std::array<std::uint8_t, D == 2 ? 32 : 128> steps;
  };
  // Bounds over bricks of the next finer level, axis 0 fastest: low > high outside of the domain.
  struct alignas(16) Bricks {
    std::array<std::uint8_t, 1 << (log2_side * D)> low, high;
  };
  // Within a brick h(x) - gradient . x lies between low and high, x in index coordinates: its
  // isosurface lies between two planes. Infinitely far apart where that is not worth a test.
  struct Slab {
    std::array<float, D> gradient{};
    float low = -std::numeric_limits<float>::infinity();
    float high = std::numeric_limits<float>::infinity();
  };

  // level 0: bricks of cells; 1, 2: of bricks. cells and bricks are in the order of dims[level].
  static constexpr int levels = 3;
  std::array<Index<D>, levels> dims;
  LargeArray<Cells> cells;
  std::array<LargeArray<Bricks>, levels - 1> bricks;  // [level - 1]
  std::array<LargeArray<Slab>, levels> slabs;

  double min = 0, per_unit = 1;
  bool is_exact = false;  // whether h = min + steps at each voxel

  double steps_at(double h) const { return (h - min) * per_unit; }

  // A voxel may be above an isovalue from may_be_above steps on, and below it under may_be_below.
  struct Limits {
    std::uint8_t may_be_above, may_be_below;
  };
  // Of an isovalue with min < isovalue <= max of the field.
  Limits limits(double isovalue) const;
};

// Of values in the range min < max without infinite ones.
template <int D>
CellBounds<D> bound_cells(const Voxels& values, const Index<D>& dims, float min, float max);

// Made for the first ray.
template <int D>
struct CellBoundsOnce {
  tbb::collaborative_once_flag flag;
  CellBounds<D> bounds;
};

}  // namespace leaflight
