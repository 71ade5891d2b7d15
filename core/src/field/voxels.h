// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace leaflight {

// The values of a grid in the type of its file, axis 0 fastest. Each value is exact as a float, so
// results equal those of a converted grid. Bytes take a quarter of its memory. Only floats can be
// NaN.
using Voxels =
    std::variant<const float*, const std::uint8_t*, const std::int16_t*, const std::uint16_t*>;

// A buffer that owns its voxels.
using VoxelBuffer = std::variant<std::vector<float>, std::vector<std::uint8_t>,
                                 std::vector<std::int16_t>, std::vector<std::uint16_t>>;

inline Voxels voxels_of(const VoxelBuffer& buffer) {
  return std::visit([](const auto& values) -> Voxels { return values.data(); }, buffer);
}

inline float value_at(const Voxels& voxels, std::size_t i) {
  return std::visit([i](const auto* values) { return static_cast<float>(values[i]); }, voxels);
}

inline const void* address_of(const Voxels& voxels, std::size_t i) {
  return std::visit([i](const auto* values) -> const void* { return values + i; }, voxels);
}

}  // namespace leaflight
