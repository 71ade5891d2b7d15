// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/line_values.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace leaflight {

template <int D>
std::vector<Vec<D, float>> voxel_gradients(const Field<D>& field, const Affine<D>& frame_to_index) {
  std::vector<Vec<D, float>> gradients(field.voxels());
  const std::size_t row = field.dims[0];
  tbb::parallel_for(std::size_t{0}, gradients.size() / row, [&](std::size_t line) {
    for (std::size_t i = line * row; i < (line + 1) * row; ++i) {
      CellPoint<D> at;
      at.cell = index_of<D>(i, field.dims);
      for (int a = 0; a < D; ++a) {
        if (at.cell[a] < field.dims[a] - 1) continue;
        --at.cell[a];
        at.local[a] = 1;
      }
      gradients[i] = Vec<D, float>(frame_to_index.pull_back_gradient(shading_gradient(field, at)));
    }
  });
  return gradients;
}

template <int D>
Planes<D>::Planes(const Field<D>& field, const TexelLattice<D>& lattice, int axis) {
  const double width = lattice.voxels_per_texel[axis];
  const int parts = std::max(1, static_cast<int>(std::ceil(width - 1e-9)));
  const int last = (lattice.resolution[axis] - 1) * parts;
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= field.dims[a];
  for (int k = 0; k <= last; ++k) {
    const double z = static_cast<double>(k) / parts, x = z * width;
    const auto voxel = static_cast<std::size_t>(x + 1e-9);
    const double between = x - static_cast<double>(voxel);
    planes.push_back(
        {z, k % parts == 0 ? k / parts : -1, voxel * stride, between < 1e-9 ? 0 : between});
  }
}

template std::vector<Vec<2, float>> voxel_gradients<2>(const Field<2>&, const Affine<2>&);
template std::vector<Vec<3, float>> voxel_gradients<3>(const Field<3>&, const Affine<3>&);
template struct Planes<2>;
template struct Planes<3>;

}  // namespace leaflight
