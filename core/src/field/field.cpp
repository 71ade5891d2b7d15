// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "base/bounds.h"
#include "base/error.h"

namespace leaflight {
namespace {

struct Survey {
  float min = std::numeric_limits<float>::infinity();
  float max = -std::numeric_limits<float>::infinity();
  bool masked = false;
  bool infinite = false;
};

template <class Value>
Survey survey(const Value* values, std::size_t n) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, 1 << 16), Survey{},
      [&](const auto& range, Survey s) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const float h = values[i];
          s.masked |= std::isnan(h);
          s.infinite |= std::isinf(h);
          s.min = std::min(s.min, std::isnan(h) ? s.min : h);
          s.max = std::max(s.max, std::isnan(h) ? s.max : h);
        }
        return s;
      },
      [](const Survey& a, const Survey& b) {
        return Survey{std::min(a.min, b.min), std::max(a.max, b.max), a.masked || b.masked,
                      a.infinite || b.infinite};
      });
}

template <int D>
void check_placement(const Index<D>& dims, const Affine<D>& index_to_world) {
  const auto check_inverse = [](bool exists) {
    if (!exists) {
      throw Error(
          "The volume's index-to-world transform cannot be inverted; check its spacing and axes.");
    }
  };
  const double volume = determinant(index_to_world);
  check_inverse(std::isfinite(volume) && volume != 0);
  double box = 1;
  for (const Vec<D>& column : index_to_world.column) {
    const double edge = column.length();
    if (!(edge >= 1 / farthest && edge <= farthest)) {
      throw Error(
          "The volume's voxels are smaller than 1e-18 or larger than 1e18 along an axis; check its "
          "spacing, and measure it in another unit.");
    }
    box *= edge;
  }
  // Compare the volume of a cell with that of a rectangular one with the same edges.
  check_inverse(std::abs(volume) >= 1e-9 * box);
  for (int corner = 0; corner < (1 << D); ++corner) {
    Vec<D> index(0.0);
    for (int a = 0; a < D; ++a) index[a] = (corner >> a) & 1 ? dims[a] - 1 : 0;
    if (!within_bounds(index_to_world.point(index))) {
      throw Error(
          "The volume reaches farther than 1e18 from the origin; check its origin and spacing, and "
          "measure it in another unit.");
    }
  }
}

// Checks the range of values, because differences use single precision.
void check_range(float min, float max) {
  constexpr double least = 1e-34, most = 1e38;
  const double range = static_cast<double>(max) - min;
  if (range >= least && range <= most) return;
  std::ostringstream text;
  text << "The values of the volume reach from " << min << " to " << max
       << ", too little or too much for single precision; give them in units in which they differ "
          "by "
       << least << " to " << most << ".";
  throw Error(text.str());
}

}  // namespace

template <int D>
Field<D> make_field(const Voxels& values, const Index<D>& dims, const Affine<D>& index_to_world,
                    std::shared_ptr<const void> owner) {  // NOLINT: it is moved from
  for (int a = 0; a < D; ++a) {
    if (dims[a] < 2) {
      throw Error("The volume has " + std::to_string(dims[a]) + " voxel(s) along axis " + "xyz"[a] +
                  std::string("; give one with at least 2 along each axis."));
    }
  }
  check_placement(dims, index_to_world);
  Field<D> field;
  field.owner = std::move(owner);
  field.values = field.shading_values = values;
  field.dims = dims;
  field.index_to_world = index_to_world;
  field.world_to_index = inverse(index_to_world);
  const Survey s =
      std::visit([&](const auto* h) { return survey(h, field.voxels()); }, field.values);
  if (s.infinite) {
    throw Error("The volume contains infinite values; replace them by NaN or by finite numbers.");
  }
  if (s.min > s.max) {
    throw Error("All voxels of the volume are NaN, so it has no isosurface; check the file.");
  }
  if (s.min == s.max) {
    std::ostringstream text;
    text << "All voxels of the volume have the same value " << s.min
         << " in single precision, so it has no isosurface; check the file, and subtract what its "
            "values have in common.";
    throw Error(text.str());
  }
  check_range(s.min, s.max);
  field.min = s.min;
  field.max = s.max;
  field.masked = s.masked;
  field.pyramid = std::make_shared<IntervalPyramid<D>>(build_pyramid<D>(values, dims));
  field.cell_bounds_once = std::make_shared<CellBoundsOnce<D>>();
  return field;
}

template <int D>
Field<D> placed(const Field<D>& field, const Affine<D>& index_to_world) {
  check_placement(field.dims, index_to_world);
  Field<D> result = field;
  result.index_to_world = index_to_world;
  result.world_to_index = inverse(index_to_world);
  return result;
}

template <int D>
std::vector<Vec<D>> world_corners(const Field<D>& field) {
  Box<D> voxels{Vec<D>(0.0), {}};
  for (int a = 0; a < D; ++a) voxels.high[a] = field.dims[a] - 1;
  std::vector<Vec<D>> corners = voxels.corners();
  for (Vec<D>& corner : corners) corner = field.index_to_world.point(corner);
  return corners;
}

template <int D>
Box<D> world_box(const Field<D>& field) {
  Box<D> box;
  for (const Vec<D>& corner : world_corners(field)) box.extend(corner);
  return box;
}

template <int D>
CellPoint<D> locate(const Field<D>& field, const Vec<D>& index_position) {
  CellPoint<D> point;
  for (int a = 0; a < D; ++a) {
    const double x = std::clamp(index_position[a], 0.0, static_cast<double>(field.dims[a] - 1));
    point.cell[a] = std::min(static_cast<int>(x), field.dims[a] - 2);
    point.local[a] = x - point.cell[a];
  }
  return point;
}

template <int D>
double interpolate(const CellCorners<D>& corners, const Vec<D>& local) {
  std::array<double, 1 << D> h = corners.h;
  for (int a = D - 1; a >= 0; --a) {
    for (int i = 0; i < (1 << a); ++i) h[i] += local[a] * (h[i + (1 << a)] - h[i]);
  }
  return h[0];
}

template <int D>
double value_at(const Field<D>& field, const Vec<D>& index_position) {
  if (!inside(field, index_position)) return std::numeric_limits<double>::quiet_NaN();
  const CellPoint<D> at = locate(field, index_position);
  return interpolate(load_corners(field, at.cell), at.local);
}

template <int D>
Vec<D> geometric_gradient(const CellCorners<D>& corners, const Vec<D>& local) {
  Vec<D> gradient;
  for (int axis = 0; axis < D; ++axis) {
    double sum = 0;
    for (int corner = 0; corner < (1 << D); ++corner) {
      if ((corner >> axis) & 1) continue;
      double weight = 1;
      for (int a = 0; a < D; ++a) {
        if (a != axis) weight *= ((corner >> a) & 1) ? local[a] : 1 - local[a];
      }
      sum += weight * (corners.h[corner | (1 << axis)] - corners.h[corner]);
    }
    gradient[axis] = sum;
  }
  return gradient;
}

template Field<2> make_field<2>(const Voxels&, const Index<2>&, const Affine<2>&,
                                std::shared_ptr<const void>);
template Field<3> make_field<3>(const Voxels&, const Index<3>&, const Affine<3>&,
                                std::shared_ptr<const void>);
template Field<2> placed(const Field<2>&, const Affine<2>&);
template Field<3> placed(const Field<3>&, const Affine<3>&);
template std::vector<Vec<2>> world_corners<2>(const Field<2>&);
template std::vector<Vec<3>> world_corners<3>(const Field<3>&);
template Box<2> world_box<2>(const Field<2>&);
template Box<3> world_box<3>(const Field<3>&);
template CellPoint<2> locate<2>(const Field<2>&, const Vec<2>&);
template CellPoint<3> locate<3>(const Field<3>&, const Vec<3>&);
template double interpolate<2>(const CellCorners<2>&, const Vec<2>&);
template double interpolate<3>(const CellCorners<3>&, const Vec<3>&);
template double value_at<2>(const Field<2>&, const Vec<2>&);
template double value_at<3>(const Field<3>&, const Vec<3>&);
template Vec<2> geometric_gradient<2>(const CellCorners<2>&, const Vec<2>&);
template Vec<3> geometric_gradient<3>(const CellCorners<3>&, const Vec<3>&);

}  // namespace leaflight
