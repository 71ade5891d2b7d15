// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/field/texel_lattice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

// Whether h crosses a value of [low, high] in the box of voxels [first, last].
bool reached(const Field<3>& field, const Index<3>& first, const Index<3>& last, double low,
             double high) {
  float min = std::numeric_limits<float>::infinity(), max = -min;
  for (int z = first[2]; z <= last[2]; ++z) {
    for (int y = first[1]; y <= last[1]; ++y) {
      const float* row = field.values + field.offset({0, y, z});
      for (int x = first[0]; x <= last[0]; ++x) {
        // Comparisons with NaN are false: masked voxels are passed over.
        if (row[x] < min) min = row[x];
        if (row[x] > max) max = row[x];
      }
    }
  }
  return min < max && min < high && max >= low;
}

}  // namespace

Index<3> TexelLattice::texel(std::uint32_t linear) const {
  const int x = static_cast<int>(linear % resolution[0]);
  const std::uint32_t row = linear / resolution[0];
  return {x, static_cast<int>(row % resolution[1]), static_cast<int>(row / resolution[1])};
}

std::int32_t TexelLattice::nearest_slot(const Vec3& index_position) const {
  Index<3> texel;
  for (int a = 0; a < 3; ++a) {
    const double x = index_position[a] / voxels_per_texel[a];
    texel[a] = std::clamp(static_cast<int>(x + 0.5), 0, resolution[a] - 1);
  }
  return slot[linear(texel)];
}

Index<3> proportional_resolution(const Field<3>& field, int longest) {
  int most = 0;
  for (int a = 0; a < 3; ++a) most = std::max(most, field.dims[a]);
  Index<3> resolution;
  for (int a = 0; a < 3; ++a) {
    const double cells = static_cast<double>(field.dims[a] - 1) / (most - 1);
    resolution[a] = std::max(2, static_cast<int>(std::lround(cells * (longest - 1))) + 1);
  }
  return resolution;
}

TexelLattice make_lattice(const Field<3>& field, const Index<3>& resolution, double low,
                          double high) {
  std::uint64_t texels = 1;
  for (int a = 0; a < 3; ++a) {
    if (resolution[a] < 2 || resolution[a] > 65535) {
      throw Error("The resolution " + std::to_string(resolution[a]) +
                  " is not possible; choose between 2 and 65535 texels along each axis.");
    }
    texels *= static_cast<std::uint64_t>(resolution[a]);
  }
  if (texels > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error("A texture of " + std::to_string(resolution[0]) + " x " +
                std::to_string(resolution[1]) + " x " + std::to_string(resolution[2]) +
                " texels is too large; choose a lower resolution.");
  }
  TexelLattice lattice;
  lattice.resolution = resolution;
  for (int a = 0; a < 3; ++a) {
    lattice.voxels_per_texel[a] = static_cast<double>(field.dims[a] - 1) / (resolution[a] - 1);
  }
  lattice.slot.assign(texels, TexelLattice::inactive);
  tbb::parallel_for(tbb::blocked_range<int>(0, resolution[2]), [&](const auto& range) {
    for (int z = range.begin(); z != range.end(); ++z) {
      for (int y = 0; y < resolution[1]; ++y) {
        for (int x = 0; x < resolution[0]; ++x) {
          const Index<3> texel{x, y, z};
          Index<3> first, last;
          for (int a = 0; a < 3; ++a) {
            const double step = lattice.voxels_per_texel[a];
            first[a] = std::max(0, static_cast<int>(std::floor((texel[a] - 1) * step)));
            last[a] =
                std::min(field.dims[a] - 1, static_cast<int>(std::ceil((texel[a] + 1) * step)));
          }
          if (reached(field, first, last, low, high)) lattice.slot[lattice.linear(texel)] = 0;
        }
      }
    }
  });
  for (std::size_t i = 0; i < texels; ++i) {
    if (lattice.slot[i] == TexelLattice::inactive) continue;
    lattice.slot[i] = static_cast<std::int32_t>(lattice.active.size());
    lattice.active.push_back(static_cast<std::uint32_t>(i));
  }
  return lattice;
}

TexelWeights trilinear_weights(const TexelLattice& lattice, const Vec3& index_position) {
  Index<3> base;
  Vec3 local;
  for (int a = 0; a < 3; ++a) {
    const double x = std::clamp(index_position[a] / lattice.voxels_per_texel[a], 0.0,
                                static_cast<double>(lattice.resolution[a] - 1));
    base[a] = std::min(static_cast<int>(x), lattice.resolution[a] - 2);
    local[a] = x - base[a];
  }
  TexelWeights result;
  double sum = 0;
  std::array<double, 8> weight;
  for (int corner = 0; corner < 8; ++corner) {
    Index<3> texel;
    weight[corner] = 1;
    for (int a = 0; a < 3; ++a) {
      const int bit = (corner >> a) & 1;
      texel[a] = base[a] + bit;
      weight[corner] *= bit ? local[a] : 1 - local[a];
    }
    result.slot[corner] = lattice.slot[lattice.linear(texel)];
    if (result.slot[corner] == TexelLattice::inactive) weight[corner] = 0;
    sum += weight[corner];
  }
  for (int corner = 0; corner < 8; ++corner) {
    result.weight[corner] = sum > 0 ? static_cast<float>(weight[corner] / sum) : 0;
  }
  return result;
}

}  // namespace leaflight
