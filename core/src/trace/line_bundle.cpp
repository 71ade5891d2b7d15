// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/line_bundle.h"

#include <algorithm>

namespace leaflight {

template <int D>
Planes<D>::Planes(const Field<D>& field, const TexelLattice<D>& lattice, int axis) {
  const double width = lattice.voxels_per_texel[axis];
  const int parts = std::max(1, static_cast<int>(std::ceil(width - 1e-9)));
  const int last = (lattice.resolution[axis] - 1) * parts;
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= field.dims[a];
  for (int k = 0; k <= last; ++k) {
    const double z = static_cast<double>(k) / parts, x = z * width;
    const auto voxel = static_cast<int>(x + 1e-9);
    const double between = x - voxel;
    planes.push_back(
        {z, k % parts == 0 ? k / parts : -1, voxel, voxel * stride, between < 1e-9 ? 0 : between});
  }
}

template struct Planes<2>;
template struct Planes<3>;

}  // namespace leaflight
