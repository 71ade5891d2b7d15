// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// Bricks of voxels in which a field is below a value, so that lines need not read it. Masked voxels
// are not empty.
template <int D>
class EmptySpace {
 public:
  static constexpr int brick_shift = 2, brick_width = 1 << brick_shift;

  EmptySpace(const Field<D>& field, double below);

  // True if every voxel is empty in this voxel's brick and in the adjacent bricks.
  bool holds(const Index<D>& voxel) const {
    Index<D> brick;
    for (int a = 0; a < D; ++a) brick[a] = voxel[a] >> brick_shift;
    return empty_[linear_number<D>(brick, bricks_)] != 0;
  }
  // Returns a value that represents empty voxels and belongs to no isosurface.
  float value() const { return value_; }

 private:
  Index<D> bricks_;
  float value_;
  std::vector<std::uint8_t> empty_;
};

}  // namespace leaflight
