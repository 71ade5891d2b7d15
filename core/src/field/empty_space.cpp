// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/empty_space.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index_range.h"

namespace leaflight {

template <int D>
EmptySpace<D>::EmptySpace(const Field<D>& field, double below)
    : value_(std::nextafter(static_cast<float>(below), -std::numeric_limits<float>::infinity())) {
  for (int a = 0; a < D; ++a) bricks_[a] = (field.dims[a] + brick_width - 1) / brick_width;
  const std::size_t count = cell_count<D>(bricks_);
  std::vector<std::uint8_t> is_below(count, 1);
  empty_.assign(count, 1);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Index<D> brick = index_of<D>(i, bricks_);
    Index<D> first, last;
    for (int a = 0; a < D; ++a) {
      first[a] = brick[a] * brick_width;
      last[a] = std::min(first[a] + brick_width, field.dims[a]);
    }
    std::visit(
        [&](const auto* values) {
          for_each_index<D>(first, last, [&](const Index<D>& voxel) {
            if (!(values[field.offset(voxel)] < below)) is_below[i] = 0;
          });
        },
        field.values);
  });
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Index<D> brick = index_of<D>(i, bricks_);
    Index<D> first, last;
    for (int a = 0; a < D; ++a) {
      first[a] = std::max(0, brick[a] - 1);
      last[a] = std::min(brick[a] + 2, bricks_[a]);
    }
    for_each_index<D>(first, last, [&](const Index<D>& other) {
      if (!is_below[linear_number<D>(other, bricks_)]) empty_[i] = 0;
    });
  });
}

template class EmptySpace<2>;
template class EmptySpace<3>;

}  // namespace leaflight
