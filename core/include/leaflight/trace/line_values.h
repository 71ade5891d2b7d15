// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "leaflight/trace/line_set.h"

namespace leaflight {

// Gradients of a field at its voxels by central differences, in the frame: what surfaces are shaded
// by, single precision.
template <int D>
std::vector<Vec<D, float>> voxel_gradients(const Field<D>& field, const Affine<D>& frame_to_index);

// Planes across one axis of a lattice at which lines are looked at: those of the texels' centres
// and, where a texel is wider than a voxel, more between them.
template <int D>
struct Planes {
  struct Plane {
    double z;            // in texels
    int texel;           // of the centre plane, or -1
    std::size_t voxels;  // the number of the first voxel of the plane below it, or in it
    double between;      // how far it lies on the way to the next plane of voxels, in [0,1)
  };
  std::vector<Plane> planes;

  Planes(const Field<D>& field, const TexelLattice<D>& lattice, int axis);
};

// A line of a set: the values of a field where it crosses the planes.
template <int D>
class LineValues {
 public:
  LineValues(const Field<D>& field, const TexelLattice<D>& lattice, const LineSet<D>& set,
             const Planes<D>& planes);

  // Takes the values along the line of these tracks.
  void follow(const std::array<int, static_cast<std::size_t>(D - 1)>& tracks);

  // The planes that it crosses within the field: [first, last], in ascending order.
  int first() const { return first_; }
  int last() const { return last_; }
  double value(int plane) const { return values_[plane]; }
  double z(int plane) const { return planes_.planes[plane].z; }
  // In texels, at a coordinate along the axis.
  Vec<D> position(double z) const {
    Vec<D> p;
    p[set_.axis] = z;
    for (int b = 0; b < D - 1; ++b) p[axes_[b]] = track_[b].at(z);
    return p;
  }
  // The direction in texels, by which z grows by 1.
  Vec<D> direction() const {
    Vec<D> d;
    d[set_.axis] = 1;
    for (int b = 0; b < D - 1; ++b) d[axes_[b]] = track_[b].slope;
    return d;
  }
  // The number of the texel whose part of a plane the line crosses, or -1: it may lie between the
  // texels' planes, or a line of a lower number may come to the same texel.
  std::int64_t texel(int plane) const;
  // Where the line crosses a plane, interpolated as the values are.
  Vec<D, float> gradient(const std::vector<Vec<D, float>>& gradients, int plane) const;

 private:
  static constexpr int across = D - 1;
  // Where the line crosses a plane: a voxel and the coordinates from it across the axis.
  struct Crossing {
    std::size_t voxel;
    std::array<float, static_cast<std::size_t>(across)> local;
  };

  const Field<D>& field_;
  const TexelLattice<D>& lattice_;
  const LineSet<D>& set_;
  const Planes<D>& planes_;
  std::array<int, static_cast<std::size_t>(across)> axes_;
  std::array<std::size_t, static_cast<std::size_t>(D)> stride_;
  std::array<int, static_cast<std::size_t>(across)> number_{};
  std::array<typename LineSet<D>::Track, static_cast<std::size_t>(across)> track_;
  int first_ = 0, last_ = -1;
  std::vector<Crossing> crossings_;
  std::vector<double> values_;
};

template <int D>
LineValues<D>::LineValues(const Field<D>& field, const TexelLattice<D>& lattice,
                          const LineSet<D>& set, const Planes<D>& planes)
    : field_(field),
      lattice_(lattice),
      set_(set),
      planes_(planes),
      crossings_(planes.planes.size()),
      values_(planes.planes.size()) {
  std::size_t stride = 1;
  for (int a = 0; a < D; stride *= field.dims[a], ++a) stride_[a] = stride;
  for (int b = 0; b < across; ++b) axes_[b] = b < set.axis ? b : b + 1;
}

template <int D>
void LineValues<D>::follow(const std::array<int, static_cast<std::size_t>(D - 1)>& tracks) {
  number_ = tracks;
  double low = set_.low, high = set_.high;
  for (int b = 0; b < across; ++b) {
    track_[b] = set_.tracks[b][tracks[b]];
    const auto [origin, slope] = track_[b];
    const double end = lattice_.resolution[axes_[b]] - 1;
    if (slope == 0) {
      if (!(origin >= 0 && origin <= end)) low = high + 1;
      continue;
    }
    const double enter = -origin / slope, leave = (end - origin) / slope;
    low = std::max(low, std::min(enter, leave));
    high = std::min(high, std::max(enter, leave));
  }
  const auto& planes = planes_.planes;
  const double per_texel = 1 / (planes[1].z - planes[0].z);
  first_ = std::max(0, static_cast<int>(std::ceil(low * per_texel - 1e-9)));
  last_ = low > high ? first_ - 1
                     : std::min(static_cast<int>(planes.size()) - 1,
                                static_cast<int>(std::floor(high * per_texel + 1e-9)));
  const float* h = field_.values;
  const std::size_t along = stride_[set_.axis], dx = stride_[axes_[0]],
                    dy = stride_[axes_[across - 1]];
  std::array<double, static_cast<std::size_t>(across)> origin, slope;
  for (int b = 0; b < across; ++b) {
    origin[b] = track_[b].origin * lattice_.voxels_per_texel[axes_[b]];
    slope[b] = track_[b].slope * lattice_.voxels_per_texel[axes_[b]];
  }
  for (int k = first_; k <= last_; ++k) {
    Crossing& at = crossings_[k];
    at.voxel = planes[k].voxels;
    for (int b = 0; b < across; ++b) {
      const double x = origin[b] + slope[b] * planes[k].z;
      const int cell = std::clamp(static_cast<int>(x), 0, field_.dims[axes_[b]] - 2);
      at.local[b] = static_cast<float>(std::clamp(x - cell, 0.0, 1.0));
      at.voxel += cell * stride_[axes_[b]];
    }
    const auto in_plane = [&](const float* v) {
      const float bottom = v[0] + (v[dx] - v[0]) * at.local[0];
      if constexpr (D == 2) return bottom;
      const float top = v[dy] + (v[dx + dy] - v[dy]) * at.local[0];
      return bottom + (top - bottom) * at.local[across - 1];
    };
    values_[k] = in_plane(h + at.voxel);
    if (planes[k].between == 0) continue;
    values_[k] += (in_plane(h + at.voxel + along) - values_[k]) * planes[k].between;
  }
}

template <int D>
std::int64_t LineValues<D>::texel(int plane) const {
  const auto& of = planes_.planes[plane];
  if (of.texel < 0) return -1;
  Index<D> texel;
  texel[set_.axis] = of.texel;
  for (int b = 0; b < across; ++b) {
    texel[axes_[b]] = static_cast<int>(track_[b].at(of.z) + 0.5);
    if (!set_.crowded || number_[b] == 0) continue;
    const double before = set_.tracks[b][number_[b] - 1].at(of.z);
    const double end = lattice_.resolution[axes_[b]] - 1;
    if (before >= 0 && before <= end && static_cast<int>(before + 0.5) == texel[axes_[b]]) {
      return -1;
    }
  }
  return static_cast<std::int64_t>(lattice_.linear(texel));
}

template <int D>
Vec<D, float> LineValues<D>::gradient(const std::vector<Vec<D, float>>& gradients,
                                      int plane) const {
  const Crossing& at = crossings_[plane];
  const std::size_t dx = stride_[axes_[0]], dy = stride_[axes_[across - 1]];
  const auto in_plane = [&](const Vec<D, float>* g) {
    const Vec<D, float> bottom = g[0] + (g[dx] - g[0]) * at.local[0];
    if constexpr (D == 2) return bottom;
    const Vec<D, float> top = g[dy] + (g[dx + dy] - g[dy]) * at.local[0];
    return bottom + (top - bottom) * at.local[across - 1];
  };
  const Vec<D, float> below = in_plane(gradients.data() + at.voxel);
  const auto between = static_cast<float>(planes_.planes[plane].between);
  if (between == 0) return below;
  return below + (in_plane(gradients.data() + at.voxel + stride_[set_.axis]) - below) * between;
}

}  // namespace leaflight
