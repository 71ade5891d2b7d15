// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/brick_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace leaflight {
namespace {

// Returns the float that replaces the isovalue in comparisons `value >= isovalue` of floats.
float threshold_of(double isovalue) {
  const float nearest = static_cast<float>(isovalue);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  return nearest < isovalue ? std::nextafter(nearest, infinity) : nearest;
}

}  // namespace

template <int D>
BrickValues<D> load_brick(const Field<D>& field, const Index<D>& brick, double isovalue) {
  constexpr int width = BrickValues<D>::width;
  BrickValues<D> values;
  std::array<int, 3> count{1, 1, 1};
  for (int a = 0; a < D; ++a) {
    values.low[a] = brick[a] * BrickValues<D>::size;
    count[a] = std::min(width, field.dims[a] - values.low[a]);
  }
  const float threshold = threshold_of(isovalue);
  const std::size_t first = field.offset(values.low);
  const std::size_t row = field.dims[0], layer = row * field.dims[1];
  // `length` is nearly always a compile-time constant.
  const auto load = [&](const auto* all, auto length) {
    for (int z = 0; z < count[2]; ++z) {
      for (int y = 0; y < count[1]; ++y) {
        const auto* from = all + first + z * layer + y * row;
        float* to = values.h.data() + (z * width + y) * width;
        unsigned above = 0, masked = 0;
        for (int x = 0; x < length; ++x) {
          const float h = from[x];
          to[x] = h;
          above |= static_cast<unsigned>(h >= threshold) << x;
          if (field.masked) masked |= static_cast<unsigned>(std::isnan(h)) << x;
        }
        values.above[z] |= std::uint64_t{above} << (8 * y);
        values.known[z] |= std::uint64_t{((1u << length) - 1) & ~masked} << (8 * y);
      }
    }
  };
  std::visit(
      [&](const auto* all) {
        if (count[0] == width) {
          load(all, std::integral_constant<int, width>{});
        } else {
          load(all, count[0]);
        }
      },
      field.values);
  return values;
}

template <int D>
void fetch_brick(const Field<D>& field, const Index<D>& brick) {
  std::array<int, 3> low{0, 0, 0}, count{1, 1, 1};
  for (int a = 0; a < D; ++a) {
    low[a] = brick[a] * BrickValues<D>::size;
    count[a] = std::min(BrickValues<D>::width, field.dims[a] - low[a]);
  }
  const std::size_t row = field.dims[0], layer = row * field.dims[1];
  const std::size_t first = low[2] * layer + low[1] * row + low[0];
  for (int z = 0; z < count[2]; ++z) {
    for (int y = 0; y < count[1]; ++y) {
      __builtin_prefetch(address_of(field.values, first + z * layer + y * row));
    }
  }
}

template void fetch_brick<2>(const Field<2>&, const Index<2>&);
template void fetch_brick<3>(const Field<3>&, const Index<3>&);
template BrickValues<2> load_brick<2>(const Field<2>&, const Index<2>&, double);
template BrickValues<3> load_brick<3>(const Field<3>&, const Index<3>&, double);

}  // namespace leaflight
