// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/shading_gradient.h"

#include <cmath>
#include <limits>

namespace leaflight {

template <int D>
bool is_lowered(const Field<D>& field, std::size_t voxel) {
  constexpr double rounding = 0.005;  // steps
  return field.ramp != nullptr &&
         value_at(field.values, voxel) >= field.ramp[voxel] - rounding * field.ramp_step;
}

namespace {

// Voxels without data and those that a cut has lowered do not count.
template <int D, class Value>
Vec<D> voxel_gradient(const Field<D>& field, const Value* values, const Index<D>& voxel) {
  Vec<D> gradient(0.0);
  const std::size_t offset = field.offset(voxel);
  const Value* h = values + offset;
  std::size_t stride = 1;
  for (int a = 0; a < D; stride *= field.dims[a], ++a) {
    double low = voxel[a] > 0 ? h[-static_cast<std::ptrdiff_t>(stride)] : h[0];
    double high = voxel[a] < field.dims[a] - 1 ? h[stride] : h[0];
    double span = (voxel[a] > 0) + (voxel[a] < field.dims[a] - 1);
    if (field.masked || field.ramp != nullptr) {
      const bool has_low = voxel[a] > 0, has_high = voxel[a] < field.dims[a] - 1;
      if (std::isnan(low) || (has_low && is_lowered(field, offset - stride))) low = h[0], span -= 1;
      if (std::isnan(high) || (has_high && is_lowered(field, offset + stride))) {
        high = h[0], span -= 1;
      }
      if (span <= 0) continue;
    }
    gradient[a] = (high - low) / span;
  }
  return gradient;
}

// Least weight of a voxel that decides if a point lies on a cut. Vertices of meshes lie on edges of
// the grid, where two weights are positive. Rounding of their positions makes others positive.
constexpr double least_weight = 1e-3;

// The voxels around a point that no cut has lowered and that the interpolation weighs.
template <int D>
struct Uncut {
  Vec<D> gradient{0.0};  // sum with the weights of the voxels
  double least = std::numeric_limits<double>::infinity();
  double weight = 0;  // sum of the weights
  bool has_lowered = false;

  // True if a point of the isosurface of this value lies on a cut: some voxels around it are
  // lowered, and all others are inside the isosurface.
  bool is_on_cut(double isovalue) const { return has_lowered && least >= isovalue; }
};

template <int D, class Value>
Uncut<D> interpolate_uncut(const Field<D>& field, const Value* shading_values,
                           const CellPoint<D>& point) {
  Uncut<D> sum;
  for (int corner = 0; corner < (1 << D); ++corner) {
    double weight = 1;
    Index<D> voxel;
    for (int a = 0; a < D; ++a) {
      const int bit = (corner >> a) & 1;
      weight *= bit ? point.local[a] : 1 - point.local[a];
      voxel[a] = point.cell[a] + bit;
    }
    if (weight == 0) continue;
    const bool decides = weight >= least_weight;
    if (is_lowered(field, field.offset(voxel))) {
      sum.has_lowered |= decides;
      continue;
    }
    sum.gradient += voxel_gradient(field, shading_values, voxel) * weight;
    if (field.ramp != nullptr && decides) {
      sum.least = std::min<double>(sum.least, field.value(voxel));
    }
    sum.weight += weight;
  }
  return sum;
}

// Interpolates the gradients at the voxels around a point. Each of them needs both of its neighbors
// along each axis.
template <int D, class Value>
Vec<D> interpolate_inside(const Field<D>& field, const Value* values, const CellPoint<D>& point) {
  std::array<std::ptrdiff_t, D> stride;
  std::ptrdiff_t step = 1;
  for (int a = 0; a < D; step *= field.dims[a], ++a) stride[a] = step;
  const Value* const first = values + field.offset(point.cell);
  Vec<D> gradient(0.0);
  for (int corner = 0; corner < (1 << D); ++corner) {
    double weight = 1;
    const Value* h = first;
    for (int a = 0; a < D; ++a) {
      const int bit = (corner >> a) & 1;
      weight *= bit ? point.local[a] : 1 - point.local[a];
      h += bit * stride[a];
    }
    if (weight == 0) continue;
    for (int a = 0; a < D; ++a) {
      const double low = h[-stride[a]], high = h[stride[a]];
      gradient[a] += (high - low) / 2 * weight;
    }
  }
  return gradient;
}

// True if the gradients at the voxels around a point are plain central differences.
template <int D>
bool has_plain_gradients(const Field<D>& field, const CellPoint<D>& point) {
  bool is_plain = !field.masked && field.ramp == nullptr;
  for (int a = 0; a < D; ++a) {
    is_plain = is_plain && point.cell[a] > 0 && point.cell[a] < field.dims[a] - 2;
  }
  return is_plain;
}

template <int D>
CellCorners<D> ramp_corners(const Field<D>& field, const Index<D>& cell) {
  CellCorners<D> corners;
  for (int corner = 0; corner < (1 << D); ++corner) {
    Index<D> voxel = cell;
    for (int a = 0; a < D; ++a) voxel[a] += (corner >> a) & 1;
    corners.h[corner] = field.ramp[field.offset(voxel)];
  }
  return corners;
}

}  // namespace

template <int D>
Vec<D> ramp_gradient(const Field<D>& field, const CellPoint<D>& point) {
  Vec<D> sum(0.0);
  int count = 0;
  for (int neighbor = 0; neighbor < (1 << D); ++neighbor) {
    CellPoint<D> at = point;
    bool touches = true;
    for (int a = 0; a < D; ++a) {
      if (!((neighbor >> a) & 1)) continue;
      const bool is_first = point.local[a] < least_weight;
      touches = touches && (is_first || point.local[a] > 1 - least_weight);
      at.cell[a] += is_first ? -1 : 1;
      at.local[a] = is_first ? 1 : 0;
      touches = touches && at.cell[a] >= 0 && at.cell[a] < field.dims[a] - 1;
    }
    if (!touches) continue;
    sum += geometric_gradient(ramp_corners(field, at.cell), at.local);
    ++count;
  }
  return sum / count;
}

template <int D>
Vec<D> shading_gradient(const Field<D>& field, const CellPoint<D>& point) {
  if (has_plain_gradients(field, point)) {
    return std::visit([&](const auto* values) { return interpolate_inside(field, values, point); },
                      field.shading_values);
  }
  const Uncut<D> uncut =
      std::visit([&](const auto* values) { return interpolate_uncut(field, values, point); },
                 field.shading_values);
  if (!uncut.has_lowered) return uncut.gradient;
  const Vec<D> on_cut = ramp_gradient(field, point);
  const double steepness = on_cut.length(), own = uncut.gradient.length();
  const double value = interpolate(load_corners(field, point.cell), point.local);
  if (own == 0 || uncut.is_on_cut(value)) return on_cut;
  if (steepness == 0) return uncut.gradient;
  // The edge of a cut is a voxel wide, so its normals turn from one side to the other.
  return uncut.gradient + on_cut * ((1 - uncut.weight) / uncut.weight * own / steepness);
}

template <int D>
Vec<D> uncut_gradient(const Field<D>& field, const CellPoint<D>& point) {
  const Uncut<D> uncut =
      std::visit([&](const auto* values) { return interpolate_uncut(field, values, point); },
                 field.shading_values);
  return uncut.weight > 0 ? uncut.gradient / uncut.weight : Vec<D>(0.0);
}

template <int D>
bool is_on_cut(const Field<D>& field, const CellPoint<D>& point, double isovalue) {
  return field.ramp != nullptr && interpolate_uncut(field, field.ramp, point).is_on_cut(isovalue);
}

template <int D>
double cap_isovalue(const Field<D>& field, const CellPoint<D>& point) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (field.ramp == nullptr) return none;
  const Uncut<D> uncut = interpolate_uncut(field, field.ramp, point);
  const double planned = interpolate(ramp_corners(field, point.cell), point.local);
  if (uncut.is_on_cut(planned)) return planned;
  const double value = interpolate(load_corners(field, point.cell), point.local);
  return uncut.is_on_cut(value) ? value : none;
}

template <int D>
Vec<D> on_ramp(const Field<D>& field, const Vec<D>& index_position, double isovalue) {
  const CellPoint<D> at = locate(field, index_position);
  const CellCorners<D> ramp = ramp_corners(field, at.cell);
  const Vec<D> gradient = geometric_gradient(ramp, at.local);
  const double square = gradient.dot(gradient);
  if (!(square > 0)) return index_position;
  return index_position - gradient * ((interpolate(ramp, at.local) - isovalue) / square);
}

template <int D>
Vec<D> flat_on_cut(const Field<D>& field, const Vec<D>& index_position, double isovalue) {
  if (!is_on_cut(field, locate(field, index_position), isovalue)) return index_position;
  return on_ramp(field, index_position, isovalue);
}

template <int D>
Vec<D> shading_normal(const Field<D>& field, const Vec<D>& index_position) {
  const Vec<D> gradient = field.world_to_index.pull_back_gradient(
      shading_gradient(field, locate(field, index_position)));
  const double length = gradient.length();
  return length > 0 ? gradient * (-1 / length) : Vec<D>(0.0);
}

template Vec<2> flat_on_cut<2>(const Field<2>&, const Vec<2>&, double);
template Vec<3> flat_on_cut<3>(const Field<3>&, const Vec<3>&, double);
template Vec<2> shading_normal<2>(const Field<2>&, const Vec<2>&);
template Vec<3> shading_normal<3>(const Field<3>&, const Vec<3>&);
template Vec<2> shading_gradient<2>(const Field<2>&, const CellPoint<2>&);
template Vec<3> shading_gradient<3>(const Field<3>&, const CellPoint<3>&);
template bool is_lowered<2>(const Field<2>&, std::size_t);
template bool is_on_cut<2>(const Field<2>&, const CellPoint<2>&, double);
template double cap_isovalue<2>(const Field<2>&, const CellPoint<2>&);
template double cap_isovalue<3>(const Field<3>&, const CellPoint<3>&);
template Vec<2> on_ramp<2>(const Field<2>&, const Vec<2>&, double);
template Vec<2> ramp_gradient<2>(const Field<2>&, const CellPoint<2>&);
template Vec<2> uncut_gradient<2>(const Field<2>&, const CellPoint<2>&);
template bool is_lowered<3>(const Field<3>&, std::size_t);
template bool is_on_cut<3>(const Field<3>&, const CellPoint<3>&, double);
template Vec<3> on_ramp<3>(const Field<3>&, const Vec<3>&, double);
template Vec<3> ramp_gradient<3>(const Field<3>&, const CellPoint<3>&);
template Vec<3> uncut_gradient<3>(const Field<3>&, const CellPoint<3>&);

}  // namespace leaflight
