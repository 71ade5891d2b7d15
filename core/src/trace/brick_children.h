// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "field/cell_bounds.h"

namespace leaflight {

// The children of a brick, numbered in rows of length `row`.
template <int D, int row>
struct Children {
  static constexpr int side = CellBounds<D>::side;

  static constexpr int stride(int axis) {
    int stride = 1;
    for (int a = 0; a < axis; ++a) stride *= row;
    return stride;
  }

  // ahead[axis][forward][place]: the children that a ray from that place along an axis may reach.
  static constexpr std::array<std::array<std::array<ChildSet, side>, 2>, D> ahead = [] {
    std::array<std::array<std::array<ChildSet, side>, 2>, D> sets{};
    int count = 1;
    for (int a = 0; a < D; ++a) count *= side;
    for (int child = 0; child < count; ++child) {
      int places[D]{}, number = 0;
      for (int a = 0, rest = child; a < D; ++a, rest /= side) {
        places[a] = rest % side;
        number += places[a] * stride(a);
      }
      for (int a = 0; a < D; ++a) {
        for (int place = 0; place < side; ++place) {
          if (places[a] >= place) sets[a][1][place].insert(number);
          if (places[a] <= place) sets[a][0][place].insert(number);
        }
      }
    }
    return sets;
  }();
};

// Returns the cells of a brick that an isosurface may cross. `above`: set to the cells that have a
// vertex above it, or may have one.
template <int D>
ChildSet crossed_cells(const CellBounds<D>& bounds, const typename CellBounds<D>::Limits& limits,
                       std::size_t brick, bool is_masked, ChildSet& above) {
  const auto& steps = bounds.cells[brick].steps;
  above = at_least(steps, limits.may_be_above);
  ChildSet below = ~(bounds.is_exact ? above : at_least(steps, limits.may_be_below));
  if (is_masked) below = below | at_least(steps, CellBounds<D>::masked);
  // Convert voxels to the cells between them.
  for (int a = 0; a < D; ++a) {
    const int stride = Children<D, CellBounds<D>::row>::stride(a);
    above = above | above.less(stride);
    below = below | below.less(stride);
  }
  return above & below;
}

// Returns the bricks inside a brick that an isosurface may cross. `above`: set to those that are
// entirely above it.
template <int D>
ChildSet crossed_bricks(const CellBounds<D>& bounds, const typename CellBounds<D>::Limits& limits,
                        int level, std::size_t brick, ChildSet& above) {
  const auto& children = bounds.bricks[level - 1][brick];
  above = at_least(children.low, limits.may_be_below);
  return at_least(children.high, limits.may_be_above) & ~above;
}

}  // namespace leaflight
