// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "base/index_range.h"
#include "base/large_array.h"
#include "field/voxels.h"

namespace leaflight {

// The range of h over a brick of cells, without masked cells; empty (min > max) if none is left.
struct Interval {
  float min;
  float max;

  // True if an isosurface crosses the brick. Values equal to the isovalue count as above, and both
  // sides must exist.
  bool crossed_by(double isovalue) const { return min < isovalue && isovalue <= max; }
};

// The minimum and maximum of h over bricks of 4^D, 16^D, ... cells. It is the interval tree of
// Wilhelms and Van Gelder (1992) as a pyramid. A cell belongs to the brick of its lowest voxel.
template <int D>
struct IntervalPyramid {
  struct Level {
    Index<D> dims;
    LargeArray<Interval> bricks;

    const Interval& at(const Index<D>& brick) const {
      return bricks[linear_number<D>(brick, dims)];
    }
  };
  static constexpr int log2_brick = 2;
  std::vector<Level> levels;  // levels[0]: bricks of 4^D cells
};

template <int D>
IntervalPyramid<D> build_pyramid(const Voxels& values, const Index<D>& dims);

}  // namespace leaflight
