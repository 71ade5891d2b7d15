// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/atlas.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace leaflight {
namespace {

// Returns the value of a texel, or the mean of its active neighbors, or black.
Vec<3, float> filled(const TexelLattice<3>& lattice, const std::vector<Vec<3, float>>& values,
                     const Index<3>& texel) {
  const std::int32_t center = lattice.slot[lattice.linear(texel)];
  if (center != TexelLattice<3>::inactive) return values[center];
  Vec<3, float> sum(0);
  int count = 0;
  Index<3> low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = std::max(0, texel[a] - 1);
    high[a] = std::min(lattice.resolution[a], texel[a] + 2);
  }
  for_each_index<3>(low, high, [&](const Index<3>& neighbor) {
    const std::int32_t slot = lattice.slot[lattice.linear(neighbor)];
    if (slot == TexelLattice<3>::inactive) return;
    sum += values[slot];
    ++count;
  });
  return count > 0 ? sum / static_cast<float>(count) : sum;
}

}  // namespace

Atlas make_atlas(const TexelLattice<3>& lattice, const std::vector<Vec<3, float>>& values) {
  const Index<3>& n = lattice.resolution;
  Atlas atlas;
  // Make the image nearly square, because graphics cards limit the longer side.
  atlas.columns = std::max(
      1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(n[2]) * n[1] / n[0]))));
  atlas.columns = std::min(atlas.columns, n[2]);
  atlas.rows = (n[2] + atlas.columns - 1) / atlas.columns;
  atlas.width = atlas.columns * n[0];
  atlas.height = atlas.rows * n[1];
  atlas.pixels.assign(static_cast<std::size_t>(atlas.width) * atlas.height * 4, 0.0f);
  tbb::parallel_for(0, n[2], [&](int z) {
    const int left = (z % atlas.columns) * n[0], bottom = (z / atlas.columns) * n[1];
    for (int y = 0; y < n[1]; ++y) {
      float* row =
          atlas.pixels.data() + (static_cast<std::size_t>(bottom + y) * atlas.width + left) * 4;
      for (int x = 0; x < n[0]; ++x) {
        const Vec<3, float> radiance = filled(lattice, values, {x, y, z});
        for (int c = 0; c < 3; ++c) row[4 * x + c] = radiance[c];
        row[4 * x + 3] = 1;
      }
    }
  });
  return atlas;
}

}  // namespace leaflight
