// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/block_workers.h"

#include <cstring>

#include "base/error.h"

namespace leaflight {
namespace {

std::size_t size_of(const SideMoments& moments) {
  return (moments[0].sums.size() + moments[1].sums.size()) * sizeof(TexelSum);
}

}  // namespace

std::string block_bytes(const SideMoments& moments, std::uint64_t lines) {
  std::string bytes(reinterpret_cast<const char*>(&lines), sizeof lines);
  bytes.reserve(sizeof lines + size_of(moments));
  for (const TexelMoments& side : moments) {
    bytes.append(reinterpret_cast<const char*>(side.sums.data()),
                 side.sums.size() * sizeof(TexelSum));
  }
  return bytes;
}

std::uint64_t take_block(const std::string& bytes, SideMoments& moments) {
  std::uint64_t lines = 0;
  if (bytes.size() != sizeof lines + size_of(moments)) {
    throw Error("A worker has traced a block of another bake; install one version for all.");
  }
  std::memcpy(&lines, bytes.data(), sizeof lines);
  const char* from = bytes.data() + sizeof lines;
  for (TexelMoments& side : moments) {
    const std::size_t size = side.sums.size() * sizeof(TexelSum);
    if (size > 0) std::memcpy(static_cast<void*>(side.sums.data()), from, size);
    from += size;
  }
  return lines;
}

}  // namespace leaflight
