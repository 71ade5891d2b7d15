// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/texture.h"

#include <cmath>

namespace leaflight {
namespace {

// The two pixels next to a coordinate and the weight of the second.
struct Neighbors {
  int low, high;
  float weight;
};

Neighbors neighbors(double coordinate, int size) {
  const double position = (coordinate - std::floor(coordinate)) * size - 0.5;
  const double low = std::floor(position);
  const auto wrap = [size](int i) { return (i % size + size) % size; };
  return {wrap(static_cast<int>(low)), wrap(static_cast<int>(low) + 1),
          static_cast<float>(position - low)};
}

}  // namespace

Rgb Texture::at(double u, double v) const {
  const Neighbors x = neighbors(u, width), y = neighbors(v, height);
  const auto row = [&](int j) {
    const auto* first = pixels.data() + static_cast<std::size_t>(j) * width;
    return first[x.low] * (1 - x.weight) + first[x.high] * x.weight;
  };
  return Rgb(row(y.low) * (1 - y.weight) + row(y.high) * y.weight);
}

}  // namespace leaflight
