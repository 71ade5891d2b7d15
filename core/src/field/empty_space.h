// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "field/field.h"

namespace leaflight {

// Where a field lies below a value, in bricks of voxels: what passes there need not read it. Masked
// voxels are not empty.
template <int D>
class EmptySpace {
 public:
  static constexpr int brick_shift = 2, brick_width = 1 << brick_shift;

  EmptySpace(const Field<D>& field, double below);

  // Whether every voxel of the brick that holds this one, and of the bricks around it, is empty.
  bool holds(const Index<D>& voxel) const {
    Index<D> brick;
    for (int a = 0; a < D; ++a) brick[a] = voxel[a] >> brick_shift;
    return empty_[linear_number<D>(brick, bricks_)] != 0;
  }
  // A value that stands for those there, which is none of an isosurface's.
  float value() const { return value_; }

 private:
  Index<D> bricks_;
  float value_;
  std::vector<std::uint8_t> empty_;
};

}  // namespace leaflight
