// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/cell_bounds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cmath>

#include "field/least_squares_slab.h"

namespace leaflight {
namespace {

constexpr std::uint8_t most_steps = 254;

// True if all values are the least plus a whole number.
template <class Value>
bool is_whole(const Value* values, std::size_t count, float min, float max) {
  if (!(static_cast<double>(max) - min <= most_steps)) return false;
  if (std::is_integral_v<Value>) return true;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 1 << 16), true,
      [&](const auto& range, bool all) {
        for (std::size_t i = range.begin(); all && i != range.end(); ++i) {
          const double above = static_cast<double>(values[i]) - min;
          all = std::isnan(above) || above == std::floor(above);
        }
        return all;
      },
      [](bool a, bool b) { return a && b; });
}

template <int D>
std::uint8_t steps_of(const CellBounds<D>& bounds, float h) {
  if (std::isnan(h)) return CellBounds<D>::masked;
  return static_cast<std::uint8_t>(std::min<double>(std::floor(bounds.steps_at(h)), most_steps));
}

template <int D, class Value>
void fill_cells(CellBounds<D>& bounds, const Value* values, const Index<D>& dims) {
  constexpr int side = CellBounds<D>::side, row = CellBounds<D>::row;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bounds.cells.size(), 64),
                    [&](const auto& range) {
                      Index<D> corner{}, end;
                      end.fill(row);
                      for (std::size_t b = range.begin(); b != range.end(); ++b) {
                        const Index<D> brick = index_of<D>(b, bounds.dims[0]);
                        auto& steps = bounds.cells[b].steps;
                        steps.fill(0);
                        int i = 0;
                        for_each_index<D>(corner, end, [&](const Index<D>& at) {
                          Index<D> voxel;
                          for (int a = 0; a < D; ++a)
                            voxel[a] = std::min(brick[a] * side + at[a], dims[a] - 1);
                          steps[i++] = steps_of(bounds, values[linear_number<D>(voxel, dims)]);
                        });
                      }
                    });
}

struct Range {
  std::uint8_t low = 255, high = 0;
};

template <int D>
Range range_of(const typename CellBounds<D>::Cells& cells) {
  constexpr int count = D == 2 ? 25 : 125;
  Range range;
  for (int i = 0; i < count; ++i) {
    // Next to a masked voxel, no bounds are known.
    if (cells.steps[i] == CellBounds<D>::masked) return {0, most_steps};
    range.low = std::min(range.low, cells.steps[i]);
    range.high = std::max(range.high, cells.steps[i]);
  }
  return range;
}

template <int D>
Range range_of(const typename CellBounds<D>::Bricks& bricks) {
  Range range;
  for (std::size_t i = 0; i < bricks.low.size(); ++i) {
    range.low = std::min(range.low, bricks.low[i]);
    range.high = std::max(range.high, bricks.high[i]);
  }
  return range;
}

// Fills bricks from those of the next finer level.
template <int D, class Finer>
void fill_bricks(LargeArray<typename CellBounds<D>::Bricks>& bricks, const Index<D>& dims,
                 const LargeArray<Finer>& finer, const Index<D>& finer_dims) {
  constexpr int side = CellBounds<D>::side;
  bricks.resize(cell_count<D>(dims));
  tbb::parallel_for(std::size_t{0}, bricks.size(), [&](std::size_t b) {
    bricks[b].low.fill(255);
    bricks[b].high.fill(0);
    Index<D> low = index_of<D>(b, dims), high;
    for (int a = 0; a < D; ++a) {
      low[a] *= side;
      high[a] = std::min(low[a] + side, finer_dims[a]);
    }
    for_each_index<D>(low, high, [&](const Index<D>& i) {
      int child = 0;
      for (int a = D - 1; a >= 0; --a) child = child * side + (i[a] - low[a]);
      const Range range = range_of<D>(finer[linear_number<D>(i, finer_dims)]);
      bricks[b].low[child] = range.low;
      bricks[b].high[child] = range.high;
    });
  });
}

// Fits slabs to the bricks of a level. `side`: their width in cells.
template <int D>
void fill_slabs(LargeArray<typename CellBounds<D>::Slab>& slabs, const Index<D>& brick_dims,
                const Voxels& values, const Index<D>& dims, int side, double margin) {
  slabs.resize(cell_count<D>(brick_dims));
  tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t b) {
    Index<D> low = index_of<D>(b, brick_dims), high;
    for (int a = 0; a < D; ++a) {
      low[a] *= side;
      high[a] = std::min(low[a] + side, dims[a] - 1);
    }
    slabs[b] = least_squares_slab<D>(values, dims, low, high, margin);
  });
}

}  // namespace

template <int D>
typename CellBounds<D>::Limits CellBounds<D>::limits(double isovalue) const {
  const double steps = std::min<double>(steps_at(isovalue), most_steps);
  const auto up = static_cast<std::uint8_t>(std::ceil(steps));
  return {is_exact ? up : static_cast<std::uint8_t>(std::floor(steps)), up};
}

template <int D>
CellBounds<D> bound_cells(const Voxels& values, const Index<D>& dims, float min, float max) {
  CellBounds<D> bounds;
  bounds.min = min;
  bounds.is_exact = std::visit(
      [&](const auto* all) { return is_whole(all, cell_count<D>(dims), min, max); }, values);
  bounds.per_unit = bounds.is_exact ? 1 : most_steps / (static_cast<double>(max) - min);
  Index<D> finer;
  for (int a = 0; a < D; ++a) finer[a] = dims[a] - 1;
  // The margin covers rounding errors of rays and of the slabs' single-precision offsets.
  const double margin = 1e-5 * (static_cast<double>(max) - min);
  int side = 1;
  for (int level = 0; level < CellBounds<D>::levels; ++level) {
    side *= CellBounds<D>::side;
    Index<D>& level_dims = bounds.dims[level];
    for (int a = 0; a < D; ++a) level_dims[a] = (finer[a] + bounds.side - 1) / bounds.side;
    if (level == 0) {
      bounds.cells.resize(cell_count<D>(level_dims));
      std::visit([&](const auto* all) { fill_cells(bounds, all, dims); }, values);
    } else if (level == 1) {
      fill_bricks<D>(bounds.bricks[0], level_dims, bounds.cells, finer);
    } else {
      fill_bricks<D>(bounds.bricks[level - 1], level_dims, bounds.bricks[level - 2], finer);
    }
    fill_slabs<D>(bounds.slabs[level], level_dims, values, dims, side, margin);
    finer = level_dims;
  }
  return bounds;
}

template struct CellBounds<2>;
template struct CellBounds<3>;
template CellBounds<2> bound_cells<2>(const Voxels&, const Index<2>&, float, float);
template CellBounds<3> bound_cells<3>(const Voxels&, const Index<3>&, float, float);

}  // namespace leaflight
