// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/interval_pyramid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>

namespace leaflight {
namespace {

constexpr Interval empty{std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};

Interval merge(const Interval& a, const Interval& b) {
  return {std::min(a.min, b.min), std::max(a.max, b.max)};
}

template <int D, class Value>
Interval cell_interval(const Value* values, const Index<D>& dims, const Index<D>& cell) {
  Interval interval = empty;
  for (int corner = 0; corner < (1 << D); ++corner) {
    Index<D> voxel;
    for (int a = 0; a < D; ++a) voxel[a] = cell[a] + ((corner >> a) & 1);
    const float h = values[linear_number<D>(voxel, dims)];
    if (std::isnan(h)) return empty;
    interval = merge(interval, {h, h});
  }
  return interval;
}

template <int D, class Value>
Interval brick_interval(const Value* values, const Index<D>& dims, const Index<D>& brick) {
  Index<D> low, high;
  for (int a = 0; a < D; ++a) {
    low[a] = brick[a] << IntervalPyramid<D>::log2_brick;
    high[a] = std::min(low[a] + (1 << IntervalPyramid<D>::log2_brick), dims[a] - 1);
    if (low[a] >= high[a]) return empty;
  }
  // Without masked voxels, the interval of the cells is that of the voxels: one load each, not 2^D.
  Index<D> high_voxel = high;
  for (int a = 0; a < D; ++a) ++high_voxel[a];
  Interval interval = empty;
  bool masked = false;
  for_each_index<D>(low, high_voxel, [&](const Index<D>& i) {
    const float h = values[linear_number<D>(i, dims)];
    masked |= std::isnan(h);
    interval = merge(interval, {h, h});
  });
  if (!masked) return interval;
  interval = empty;
  for_each_index<D>(low, high, [&](const Index<D>& cell) {
    interval = merge(interval, cell_interval<D>(values, dims, cell));
  });
  return interval;
}

}  // namespace

template <int D>
IntervalPyramid<D> build_pyramid(const Voxels& values, const Index<D>& dims) {
  constexpr int size = 1 << IntervalPyramid<D>::log2_brick;
  IntervalPyramid<D> pyramid;
  Index<D> level_dims = dims;
  do {
    typename IntervalPyramid<D>::Level level;
    for (int a = 0; a < D; ++a) level.dims[a] = (level_dims[a] + size - 1) / size;
    level.bricks.resize(cell_count<D>(level.dims));
    const auto* finer = pyramid.levels.empty() ? nullptr : &pyramid.levels.back();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, level.bricks.size(), 256), [&](auto range) {
          for (std::size_t b = range.begin(); b != range.end(); ++b) {
            const Index<D> brick = index_of<D>(b, level.dims);
            // Compute the finest level from the voxels, and others by merging finer bricks.
            if (!finer) {
              level.bricks[b] = std::visit(
                  [&](const auto* h) { return brick_interval<D>(h, dims, brick); }, values);
              continue;
            }
            Index<D> low, high;
            for (int a = 0; a < D; ++a) {
              low[a] = brick[a] * size;
              high[a] = std::min(low[a] + size, finer->dims[a]);
            }
            Interval interval = empty;
            for_each_index<D>(low, high,
                              [&](const Index<D>& i) { interval = merge(interval, finer->at(i)); });
            level.bricks[b] = interval;
          }
        });
    level_dims = level.dims;
    pyramid.levels.push_back(std::move(level));
  } while (cell_count<D>(level_dims) > 1);
  return pyramid;
}

template IntervalPyramid<2> build_pyramid<2>(const Voxels&, const Index<2>&);
template IntervalPyramid<3> build_pyramid<3>(const Voxels&, const Index<3>&);

}  // namespace leaflight
