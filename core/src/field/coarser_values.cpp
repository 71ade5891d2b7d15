// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/coarser_values.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "field/texel_lattice.h"

namespace leaflight {

namespace {

// A term of a mean: a voxel and its weight.
struct Part {
  int voxel;
  float weight;
};

// Adds the terms of a linear interpolation. Terms of weight zero are skipped, because they may be
// NaN.
void add_interpolation(std::vector<Part>& parts, double position, double weight) {
  const double below = std::floor(position);
  const auto voxel = static_cast<int>(below);
  const double above = position - below;
  for (const Part part : {Part{voxel, static_cast<float>(weight * (1 - above))},
                          Part{voxel + 1, static_cast<float>(weight * above)}}) {
    if (part.weight != 0) parts.push_back(part);
  }
}

// Returns the means for each voxel of an axis with `coarse` instead of `fine` voxels.
std::vector<std::vector<Part>> means_along_axis(int fine, int coarse) {
  std::vector<std::vector<Part>> means(coarse);
  means.front() = {{0, 1}};
  means.back() = {{fine - 1, 1}};
  for (int i = 1; i < coarse - 1; ++i) {
    const double position = static_cast<double>(i) * (fine - 1) / (coarse - 1);
    add_interpolation(means[i], position - 1, 0.125);
    add_interpolation(means[i], position, 0.75);
    add_interpolation(means[i], position + 1, 0.125);
  }
  return means;
}

template <class Value>
std::vector<float> coarser_along(const Value* values, const Index<3>& dims, int axis, int coarse) {
  // Number of voxels in a row of the lower axes, and number of rows of the higher axes.
  std::size_t row = 1, times = 1;
  for (int a = 0; a < axis; ++a) row *= dims[a];
  for (int a = axis + 1; a < 3; ++a) times *= dims[a];
  const std::vector<std::vector<Part>> means = means_along_axis(dims[axis], coarse);
  std::vector<float> result(row * coarse * times);
  tbb::parallel_for(std::size_t{0}, coarse * times, [&](std::size_t number) {
    const Value* const from = values + number / coarse * dims[axis] * row;
    float* const to = result.data() + number * row;
    for (const Part& part : means[number % coarse]) {
      const Value* const voxels = from + part.voxel * row;
      for (std::size_t i = 0; i < row; ++i) to[i] += part.weight * voxels[i];
    }
  });
  return result;
}

}  // namespace

std::vector<float> coarser_values(const Field<3>& field) {
  Index<3> dims = field.dims;
  const Index<3> coarse = coarser_resolution<3>(dims, 2);
  std::vector<float> values = std::visit(
      [&](const auto* all) { return coarser_along(all, dims, 2, coarse[2]); }, field.values);
  for (const int axis : {1, 0}) {
    dims[axis + 1] = coarse[axis + 1];
    values = coarser_along(values.data(), dims, axis, coarse[axis]);
  }
  return values;
}

}  // namespace leaflight
