// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "field/texel_lattice.h"
#include "scene/scene.h"

namespace leaflight {

// Visibility maps as in a file: compressed codes, in blocks that unpack in parallel. Each code is
// stored as its difference from the code of the texel before.
template <int D>
struct StoredMaps {
  static constexpr std::size_t block = std::size_t{1} << 16;  // texels

  TexelLattice<D> lattice;
  std::size_t points = 0;
  IsovalueRange code_range;  // in values of the field
  bool has_back = false;
  bool has_dark = false;  // true if a mesh casts shadows into the volume
  // By side. The number of a block is (block of texels) * points + point.
  std::array<std::vector<std::string>, 2> codes;
};

// Compresses the codes of texels; their index is slot * points + point.
std::vector<std::string> stored_codes(const std::vector<std::uint8_t>& codes, std::size_t texels,
                                      std::size_t points);

// Restores codes, and writes the least code of each texel. Throws std::runtime_error if blocks are
// damaged.
void restore_codes(const std::vector<std::string>& blocks, std::size_t texels, std::size_t points,
                   std::vector<std::uint8_t>& codes, std::vector<std::uint8_t>& least);

}  // namespace leaflight
