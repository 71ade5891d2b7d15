// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/radiance_grid.h"

namespace leaflight {

Vec<3, float> lookup(const RadianceGrid& grid, const Vec3& index_position) {
  const TexelWeights weights = trilinear_weights(grid.lattice, index_position);
  Vec<3, float> radiance(0);
  for (int i = 0; i < 8; ++i) {
    if (weights.weight[i] > 0) radiance += grid.radiance[weights.slot[i]] * weights.weight[i];
  }
  return radiance;
}

}  // namespace leaflight
