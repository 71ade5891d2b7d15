// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/line_bundle.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace leaflight {

template <int D>
VoxelGradients<D> voxel_gradients(const Field<D>& field, const Affine<D>& frame_to_index) {
  VoxelGradients<D> gradients(field.voxels());
  const int row = field.dims[0];
  tbb::parallel_for(std::size_t{0}, gradients.size() / row, [&](std::size_t line) {
    Index<D> voxel = index_of<D>(line * row, field.dims);
    for (; voxel[0] < row; ++voxel[0]) {
      Vec<D> gradient;
      if (field.masked) {
        // None where a voxel of the cell is masked.
        CellPoint<D> at{voxel};
        for (int a = 0; a < D; ++a) {
          if (voxel[a] < field.dims[a] - 1) continue;
          --at.cell[a];
          at.local[a] = 1;
        }
        gradient = shading_gradient(field, at);
      } else {
        gradient = voxel_gradient(field, voxel);
      }
      gradients[line * row + voxel[0]] = Vec<D, float>(frame_to_index.pull_back_gradient(gradient));
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

template VoxelGradients<2> voxel_gradients<2>(const Field<2>&, const Affine<2>&);
template VoxelGradients<3> voxel_gradients<3>(const Field<3>&, const Affine<3>&);
template struct Planes<2>;
template struct Planes<3>;

}  // namespace leaflight
