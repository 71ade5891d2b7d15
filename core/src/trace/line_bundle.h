// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "field/empty_space.h"
#include "trace/line_set.h"

namespace leaflight {

// Planes across one axis of a lattice at which lines are sampled. They pass through the texels'
// centers; if a texel is wider than a voxel, there are more between them.
template <int D>
struct Planes {
  struct Plane {
    double z;            // in texels
    int texel;           // texel of a plane through centers, or -1
    int voxel;           // plane of voxels at or below it
    std::size_t voxels;  // number of that plane's first voxel
    double between;      // fraction of the distance to the next plane of voxels, in [0,1)
  };
  std::vector<Plane> planes;

  Planes(const Field<D>& field, const TexelLattice<D>& lattice, int axis);
};

// Lines of a set on neighboring tracks that cross the planes together, so that their reads are
// adjacent. It holds the values of a field where the lines cross the planes. Each line is a lane.
// Empty space is not read.
template <int D>
class LineBundle {
 public:
  static constexpr int width = 8;
  using Tracks = std::array<int, static_cast<std::size_t>(D - 1)>;

  LineBundle(const Field<D>& field, const EmptySpace<D>& empty, const TexelLattice<D>& lattice,
             const LineSet<D>& set, const Planes<D>& planes);

  // Samples the line of these tracks and the lines of the next first tracks.
  void follow(const Tracks& tracks);
  int lanes() const { return lanes_; }

  // Returns the range of planes [first, last] that any line, or one line, crosses within the field.
  int first() const { return all_.first; }
  int last() const { return all_.last; }
  int first(int lane) const { return range_[lane].first; }
  int last(int lane) const { return range_[lane].last; }
  float value(int plane, int lane) const { return rows_[plane].value[lane]; }
  // True if all lines are in empty space at a plane.
  bool is_empty(int plane) const { return rows_[plane].is_empty; }
  double z(int plane) const { return planes_.planes[plane].z; }
  // Returns a line's position in texels at a coordinate along the axis.
  Vec<D> position(int lane, double z) const {
    Vec<D> p;
    p[set_.axis] = z;
    p[axes_[0]] = track_[lane].at(z);
    if constexpr (D == 3) p[axes_[1]] = row_track_.at(z);
    return p;
  }
  // Returns the direction in texels per unit of z.
  Vec<D> direction(int lane) const {
    Vec<D> d;
    d[set_.axis] = 1;
    d[axes_[0]] = track_[lane].slope;
    if constexpr (D == 3) d[axes_[1]] = row_track_.slope;
    return d;
  }
  // Returns the number of the texel that the line crosses in a plane, or -1 between the texels'
  // planes and in empty space.
  std::int64_t texel(int plane, int lane) const;
  // Returns the derivative of the value along z, by central differences. Its unit is about the
  // field's range, so that its square fits a float for any data.
  float slope(int plane, int lane) const;

 private:
  static constexpr int across = D - 1;
  using Track = typename LineSet<D>::Track;
  struct PlaneRange {
    int first, last;
  };
  // The lines at a plane.
  struct Row {
    std::array<float, width> value;
    std::array<float, width> local;         // coordinate across the axis from a voxel on
    std::array<std::int32_t, width> voxel;  // from the row's first voxel on
    std::array<std::int32_t, width> texel;
    std::size_t first_voxel;
    std::int32_t row_cell;
    float row_local;
    std::int32_t row_texel;
    bool is_empty;
  };

  PlaneRange range_of(const Track& track, int axis) const;
  void take_tracks(const Tracks& tracks);
  // Computes where the lines cross plane k.
  void cross(int k);
  // Reads the values of the rows.
  template <class Value>
  void read(const Value* values);
  // True if the plane is in empty space at all lanes.
  bool in_empty_space(int plane, int row_cell) const;

  const Field<D>& field_;
  const EmptySpace<D>& empty_;
  const TexelLattice<D>& lattice_;
  const LineSet<D>& set_;
  const Planes<D>& planes_;
  float per_range_;  // a power of two, so that scaling is exact
  double planes_per_texel_;
  std::array<int, static_cast<std::size_t>(across)> axes_;
  std::array<std::size_t, static_cast<std::size_t>(D)> stride_;
  int lanes_ = 0;
  std::array<Track, width> track_;
  std::array<PlaneRange, width> range_;
  PlaneRange all_{0, -1};
  Track row_track_{0, 0};
  std::vector<Row> rows_;
};

template <int D>
LineBundle<D>::LineBundle(const Field<D>& field, const EmptySpace<D>& empty,
                          const TexelLattice<D>& lattice, const LineSet<D>& set,
                          const Planes<D>& planes)
    : field_(field),
      empty_(empty),
      lattice_(lattice),
      set_(set),
      planes_(planes),
      per_range_(std::ldexp(1.0f, -std::ilogb(field.max - field.min))),
      rows_(planes.planes.size()) {
  planes_per_texel_ = 1 / (planes.planes[1].z - planes.planes[0].z);
  std::size_t stride = 1;
  for (int a = 0; a < D; stride *= field.dims[a], ++a) stride_[a] = stride;
  for (int b = 0; b < across; ++b) axes_[b] = b < set.axis ? b : b + 1;
}

template <int D>
typename LineBundle<D>::PlaneRange LineBundle<D>::range_of(const Track& track, int axis) const {
  double low = 0, high = lattice_.resolution[set_.axis] - 1;
  const double end = lattice_.resolution[axis] - 1;
  if (track.slope == 0) {
    if (!(track.origin >= 0 && track.origin <= end)) return {0, -1};
  } else {
    const double enter = -track.origin / track.slope, leave = (end - track.origin) / track.slope;
    low = std::max(low, std::min(enter, leave));
    high = std::min(high, std::max(enter, leave));
  }
  if (low > high) return {0, -1};
  return {std::max(0, static_cast<int>(std::ceil(low * planes_per_texel_ - 1e-9))),
          std::min(static_cast<int>(planes_.planes.size()) - 1,
                   static_cast<int>(std::floor(high * planes_per_texel_ + 1e-9)))};
}

template <int D>
void LineBundle<D>::follow(const Tracks& tracks) {
  take_tracks(tracks);
  for (int k = all_.first; k <= all_.last; ++k) cross(k);
  std::visit([this](const auto* values) { this->read(values); }, field_.values);
}

template <int D>
void LineBundle<D>::take_tracks(const Tracks& tracks) {
  const std::vector<Track>& all = set_.tracks[0];
  lanes_ = std::min(width, static_cast<int>(all.size()) - tracks[0]);
  PlaneRange row{0, static_cast<int>(planes_.planes.size()) - 1};
  if constexpr (D == 3) {
    row_track_ = set_.tracks[1][tracks[1]];
    row = range_of(row_track_, axes_[1]);
  }
  all_ = {static_cast<int>(planes_.planes.size()), -1};
  for (int i = 0; i < width; ++i) {
    const int number = tracks[0] + i;
    const bool exists = i < lanes_;
    // Lanes without a line repeat the nearest line, so that they cause no other reads.
    track_[i] = all[std::min(number, static_cast<int>(all.size()) - 1)];
    range_[i] = exists ? range_of(track_[i], axes_[0]) : PlaneRange{0, -1};
    range_[i] = {std::max(range_[i].first, row.first), std::min(range_[i].last, row.last)};
    if (range_[i].first > range_[i].last) continue;
    all_ = {std::min(all_.first, range_[i].first), std::max(all_.last, range_[i].last)};
  }
}

template <int D>
void LineBundle<D>::cross(int k) {
  const double scale = lattice_.voxels_per_texel[axes_[0]];
  const int last_cell = field_.dims[axes_[0]] - 2, end = lattice_.resolution[axes_[0]] - 1;
  const auto dx = static_cast<std::int32_t>(stride_[axes_[0]]);
  const auto& plane = planes_.planes[k];
  Row& at = rows_[k];
  at.first_voxel = plane.voxels;
  at.row_cell = 0;
  if constexpr (D == 3) {
    const double y = row_track_.at(plane.z), voxels = y * lattice_.voxels_per_texel[axes_[1]];
    const int cell = std::clamp(static_cast<int>(voxels), 0, field_.dims[axes_[1]] - 2);
    at.row_cell = cell;
    at.row_local = static_cast<float>(std::clamp(voxels - cell, 0.0, 1.0));
    at.first_voxel += cell * stride_[axes_[1]];
    at.row_texel = static_cast<int>(y + 0.5);
  }
  at.is_empty = in_empty_space(k, at.row_cell);
  if (at.is_empty) return;
  std::array<double, width> x;
  for (int i = 0; i < width; ++i) x[i] = track_[i].origin + track_[i].slope * plane.z;
  for (int i = 0; i < width; ++i) {
    at.texel[i] = std::clamp(static_cast<int>(x[i] + 0.5), 0, end);
  }
  for (int i = 0; i < width; ++i) {
    const double voxels = x[i] * scale;
    const int cell = std::clamp(static_cast<int>(voxels), 0, last_cell);
    at.local[i] = static_cast<float>(std::clamp(voxels - cell, 0.0, 1.0));
    at.voxel[i] = cell * dx;
  }
  // Prefetch, because planes are far apart in memory.
  for (const int i : {0, width - 1}) {
    const std::size_t voxel = at.first_voxel + at.voxel[i];
    __builtin_prefetch(address_of(field_.values, voxel));
    __builtin_prefetch(address_of(field_.values, voxel + stride_[axes_[across - 1]]));
  }
}

template <int D>
template <class Value>
void LineBundle<D>::read(const Value* values) {
  const std::size_t along = stride_[set_.axis], dx = stride_[axes_[0]];
  for (int k = all_.first; k <= all_.last; ++k) {
    const auto& plane = planes_.planes[k];
    Row& at = rows_[k];
    if (at.is_empty) {
      at.value.fill(empty_.value());
      continue;
    }
    const auto in_row = [&](const Value* p, int i) {
      const float low = p[0], high = p[dx];
      return low + (high - low) * at.local[i];
    };
    const auto in_plane = [&](const Value* v, int i) {
      const Value* p = v + at.voxel[i];
      const float bottom = in_row(p, i);
      if constexpr (D == 2) return bottom;
      const float top = in_row(p + stride_[axes_[across - 1]], i);
      return bottom + (top - bottom) * at.row_local;
    };
    const Value* h = values + at.first_voxel;
    for (int i = 0; i < width; ++i) at.value[i] = in_plane(h, i);
    if (plane.between == 0) continue;
    const auto between = static_cast<float>(plane.between);
    for (int i = 0; i < width; ++i) {
      at.value[i] += (in_plane(h + along, i) - at.value[i]) * between;
    }
  }
}

template <int D>
bool LineBundle<D>::in_empty_space(int plane, int row_cell) const {
  const double z = planes_.planes[plane].z;
  const double scale = lattice_.voxels_per_texel[axes_[0]];
  // Each of these lanes also covers the bricks on both sides of its brick.
  constexpr std::array<int, 3> lanes{0, 3, width - 1};
  if ((track_[width - 1].at(z) - track_[0].at(z)) * scale > 4 * EmptySpace<D>::brick_width)
    return false;
  Index<D> voxel;
  voxel[set_.axis] = std::min(static_cast<int>(z * lattice_.voxels_per_texel[set_.axis] + 1e-9),
                              field_.dims[set_.axis] - 1);
  if constexpr (D == 3) voxel[axes_[1]] = row_cell;
  for (const int lane : lanes) {
    voxel[axes_[0]] =
        std::clamp(static_cast<int>(track_[lane].at(z) * scale), 0, field_.dims[axes_[0]] - 2);
    if (!empty_.holds(voxel)) return false;
  }
  return true;
}

template <int D>
std::int64_t LineBundle<D>::texel(int plane, int lane) const {
  const auto& sampled_plane = planes_.planes[plane];
  if (sampled_plane.texel < 0) return -1;
  const Row& at = rows_[plane];
  if (at.is_empty) return -1;
  Index<D> texel;
  texel[set_.axis] = sampled_plane.texel;
  texel[axes_[0]] = at.texel[lane];
  if constexpr (D == 3) texel[axes_[1]] = at.row_texel;
  return static_cast<std::int64_t>(lattice_.linear(texel));
}

template <int D>
float LineBundle<D>::slope(int plane, int lane) const {
  const int before = std::max(plane - 1, first(lane)), after = std::min(plane + 1, last(lane));
  const float h = value(plane, lane);
  float low = value(before, lane), high = value(after, lane);
  int planes = after - before;
  // Use one-sided differences next to masked voxels.
  if (std::isnan(low)) low = h, --planes;
  if (std::isnan(high)) high = h, --planes;
  if (planes <= 0) return 0;
  return (high - low) * per_range_ * static_cast<float>(planes_per_texel_ / planes);
}

}  // namespace leaflight
