// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "field/field.h"

namespace leaflight {

// Inputs of contouring in a brick of cells: the values at all corners of its cells, and which of
// them are above the isovalue. The corners are the brick's voxels and the adjacent ones.
template <int D>
struct BrickValues {
  static constexpr int size = 1 << IntervalPyramid<D>::log2_brick;
  static constexpr int width = size + 1;
  static constexpr int layers = D == 3 ? width : 1;
  static_assert(size == 4, "the masks below are of four rows of four");

  Index<D> low;  // first voxel
  // Axis 0 is fastest; values beyond the domain are unset.
  std::array<float, width * width * layers> h;

  // Bit 8 y + x of layer z. Voxels that are masked or beyond the domain are neither known nor
  // above.
  std::array<std::uint64_t, layers> above{}, known{};

  // Returns the edges along an axis between a value above and one below. The edge or cell of voxel
  // (x, y, z) of the brick has bit 16 z + 4 y + x.
  std::uint64_t crossed_edges(int axis) const {
    std::uint64_t crossed = 0;
    for (int z = 0; z < std::min(layers, size); ++z) {
      const int shift = axis == 0 ? 1 : 8, next = z + (axis == 2);
      const auto beside = [&](const auto& layer) {
        return axis == 2 ? layer[next] : layer[z] >> shift;
      };
      crossed |= packed((above[z] ^ beside(above)) & known[z] & beside(known)) << (16 * z);
    }
    return crossed;
  }
  // Returns the cells with values above and below, and no unknown values.
  std::uint64_t crossed_cells() const {
    std::uint64_t crossed = 0;
    for (int z = 0; z < std::min(layers, size); ++z) {
      std::uint64_t some = 0, all = ~std::uint64_t{0}, whole = all;
      for (int layer = z; layer < z + D - 1; ++layer) {
        for (const int shift : {0, 1, 8, 9}) {
          some |= above[layer] >> shift;
          all &= above[layer] >> shift;
          whole &= known[layer] >> shift;
        }
      }
      crossed |= packed(some & ~all & whole) << (16 * z);
    }
    return crossed;
  }

  // Returns the corners above the isovalue, one bit each, of the cell with this bit.
  unsigned corners_above(int bit) const {
    const int shift = 8 * ((bit >> 2) & 3) + (bit & 3), z = bit >> 4;
    unsigned corners = 0;
    for (int layer = 0; layer < D - 1; ++layer) {
      const std::uint64_t rows = above[z + layer] >> shift;
      corners |= static_cast<unsigned>((rows & 3) | ((rows >> 6) & 12)) << (4 * layer);
    }
    return corners;
  }
  // Returns the index in h of the voxel with this bit.
  static int place(int bit) { return ((bit >> 4) * width + ((bit >> 2) & 3)) * width + (bit & 3); }
  static int stride(int axis) { return axis == 0 ? 1 : axis == 1 ? width : width * width; }
  Index<D> voxel(int bit) const {
    Index<D> voxel;
    for (int a = 0; a < D; ++a) voxel[a] = low[a] + ((bit >> (2 * a)) & 3);
    return voxel;
  }

 private:
  // Packs four of eight bits in each of four bytes.
  static std::uint64_t packed(std::uint64_t rows) {
    rows &= 0x0F0F0F0F;
    rows = (rows | (rows >> 4)) & 0x00FF00FF;
    return (rows | (rows >> 8)) & 0xFFFF;
  }
};

template <int D>
BrickValues<D> load_brick(const Field<D>& field, const Index<D>& brick, double isovalue);

// Prefetches the memory that load_brick() will read, because its rows are far apart.
template <int D>
void fetch_brick(const Field<D>& field, const Index<D>& brick);

}  // namespace leaflight
