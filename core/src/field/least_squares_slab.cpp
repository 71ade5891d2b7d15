// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/least_squares_slab.h"

#include <cmath>

namespace leaflight {
namespace {

// Upper bound on the relative width of a slab; wider slabs hardly shorten a ray's way.
constexpr double worth = 0.5;

// Calls visit(values of a row along axis 0, its first voxel) for each row of a box of voxels.
template <int D, class Value, class Visit>
void for_each_row(const Value* values, const Index<D>& dims, const Index<D>& low,
                  const Index<D>& high, const Visit& visit) {
  Index<D> end;
  for (int a = 0; a < D; ++a) end[a] = (a == 0 ? low : high)[a] + 1;
  for_each_index<D>(low, end,
                    [&](const Index<D>& row) { visit(values + linear_number<D>(row, dims), row); });
}

template <int D, class Value>
std::array<float, D> best_gradient(const Value* values, const Index<D>& dims, const Index<D>& low,
                                   const Index<D>& high) {
  Vec<D> center, moment(0.0);
  double count = 1;
  for (int a = 0; a < D; ++a) {
    center[a] = 0.5 * (low[a] + high[a]);
    count *= high[a] - low[a] + 1;
  }
  const int length = high[0] - low[0] + 1;
  for_each_row<D>(values, dims, low, high, [&](const Value* h, const Index<D>& row) {
    double sum = 0, along = 0;
    for (int x = 0; x < length; ++x) {
      sum += h[x];
      along += (low[0] + x - center[0]) * h[x];
    }
    moment[0] += along;
    for (int a = 1; a < D; ++a) moment[a] += (row[a] - center[a]) * sum;
  });
  std::array<float, D> gradient;
  for (int a = 0; a < D; ++a) {
    // In a box of voxels, the axes are uncorrelated; n consecutive integers have this variance.
    const double n = high[a] - low[a] + 1, variance = (n * n - 1) / 12;
    gradient[a] = static_cast<float>(moment[a] / (count * variance));
  }
  return gradient;
}

template <int D, class Value>
typename CellBounds<D>::Slab slab_of(const Value* values, const Index<D>& dims, const Index<D>& low,
                                     const Index<D>& high, double margin) {
  const auto g = best_gradient<D>(values, dims, low, high);
  double first = std::numeric_limits<double>::infinity(), last = -first;
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  bool masked = false;
  const int length = high[0] - low[0] + 1;
  for_each_row<D>(values, dims, low, high, [&](const Value* h, const Index<D>& row) {
    double base = 0;
    for (int a = 1; a < D; ++a) base += static_cast<double>(g[a]) * row[a];
    for (int x = 0; x < length; ++x) {
      const double rest = h[x] - (base + static_cast<double>(g[0]) * (low[0] + x));
      first = std::min(first, rest);
      last = std::max(last, rest);
      least = std::min(least, static_cast<float>(h[x]));
      greatest = std::max(greatest, static_cast<float>(h[x]));
      masked |= std::isnan(static_cast<float>(h[x]));
    }
  });
  if (masked || !(last - first < worth * (static_cast<double>(greatest) - least))) return {};
  return {g, static_cast<float>(first - margin), static_cast<float>(last + margin)};
}

}  // namespace

template <int D>
typename CellBounds<D>::Slab least_squares_slab(const Voxels& values, const Index<D>& dims,
                                                const Index<D>& low, const Index<D>& high,
                                                double margin) {
  return std::visit([&](const auto* typed) { return slab_of<D>(typed, dims, low, high, margin); },
                    values);
}

template CellBounds<2>::Slab least_squares_slab<2>(const Voxels&, const Index<2>&, const Index<2>&,
                                                   const Index<2>&, double);
template CellBounds<3>::Slab least_squares_slab<3>(const Voxels&, const Index<3>&, const Index<3>&,
                                                   const Index<3>&, double);

}  // namespace leaflight
