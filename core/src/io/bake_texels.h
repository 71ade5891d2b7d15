// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "bake/output/radiance_grid.h"

namespace leaflight {

// The part of a bake's file behind its OpenVDB grids: light and visibility maps, in blocks that
// unpack in parallel. OpenVDB ignores it. It ends with its position and a mark.

// Writes the light of the volumes. `runs`: for each volume, the runs_of() its field's grid.
void write_texels(std::ostream& stream, const std::vector<const RadianceGrid<3>*>& grids,
                  const std::vector<std::vector<std::uint64_t>>& runs);

// Ends the part that begins at a position of the stream.
void end_texels(std::ostream& stream, std::uint64_t begin);

// Reads this part in the order in which it was written. All functions throw std::runtime_error if
// the file is damaged.
class TexelReader {
 public:
  // Returns a reader, or nothing if the file lacks this part. `length`: of the file without seal.
  static std::optional<TexelReader> open(const std::filesystem::path& path, std::uint64_t length);

  std::size_t volumes() const { return volumes_; }
  std::vector<std::uint64_t> runs();
  // Reads the light of the next volume, of `dims` voxels.
  RadianceGrid<3> grid(const Index<3>& dims);

 private:
  TexelReader() = default;
  template <class Value>
  Value value();
  std::string bytes(std::uint64_t count);
  std::vector<std::string> blocks(std::uint64_t count);
  RankedSet set(std::size_t bound);
  TexelLattice<3> lattice(const Index<3>& dims, bool layered);
  PackedNumbers numbers(std::size_t count, int channels);
  std::shared_ptr<const StoredMaps<3>> maps(const Index<3>& dims);

  std::ifstream stream_;
  std::uint64_t left_ = 0;
  std::size_t volumes_ = 0;
};

}  // namespace leaflight
