// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_texture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/index_range.h"

namespace leaflight {
namespace {

// The voxels around a position, and the weight of the upper one along each axis.
template <int D>
struct Neighborhood {
  Index<D> low, high;
  Vec<D> weight;
};

// Returns nothing outside the grid.
template <int D>
std::optional<Neighborhood<D>> around(const Vec<D>& position, const Index<D>& dims) {
  Neighborhood<D> found;
  for (int a = 0; a < D; ++a) {
    if (!(position[a] >= -0.5 && position[a] <= dims[a] - 0.5)) return std::nullopt;
    const double inside = std::clamp(position[a], 0.0, static_cast<double>(dims[a] - 1));
    found.low[a] = static_cast<int>(inside);
    found.high[a] = std::min(found.low[a] + 1, dims[a] - 1);
    found.weight[a] = inside - found.low[a];
  }
  return found;
}

template <int D>
double interpolated(const Voxels& values, const Index<D>& dims, const Neighborhood<D>& near) {
  double sum = 0;
  for (int corner = 0; corner < 1 << D; ++corner) {
    double weight = 1;
    Index<D> voxel;
    for (int a = 0; a < D; ++a) {
      const bool upper = (corner >> a & 1) != 0;
      weight *= upper ? near.weight[a] : 1 - near.weight[a];
      voxel[a] = upper ? near.high[a] : near.low[a];
    }
    if (weight > 0) sum += weight * leaflight::value_at(values, linear_number<D>(voxel, dims));
  }
  return sum;
}

}  // namespace

template <int D>
Rgb VolumeTexture<D>::at(const Vec<D>& position) const {
  std::optional<Neighborhood<D>> near = around<D>(to_texture.point(position), dims);
  if (!near) return Rgb(1);
  if (nearest) {
    for (int a = 0; a < D; ++a) near->weight[a] = near->weight[a] < 0.5 ? 0 : 1;
  }
  Rgb color;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const double value = interpolated<D>(channels[i].values, dims, *near);
    if (std::isnan(value)) return Rgb(1);
    const Rgb found = colors.at(value);
    if (channels.size() == 1) return found;
    color[static_cast<int>(i)] = found[static_cast<int>(i)];
  }
  return color;
}

template struct VolumeTexture<2>;
template struct VolumeTexture<3>;

}  // namespace leaflight
