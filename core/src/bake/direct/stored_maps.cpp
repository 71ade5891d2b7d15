// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/stored_maps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>

#include "bake/direct/direct_light.h"
#include "base/packed_numbers.h"

namespace leaflight {
namespace {

// Calls body(first texel, number of texels, first block) for each block of texels, in parallel.
template <class Body>
void for_each_block(std::size_t texels, std::size_t points, Body body) {
  constexpr std::size_t block = StoredMaps<3>::block;
  tbb::parallel_for(std::size_t{0}, blocks_of(texels, block), [&](std::size_t b) {
    body(b * block, std::min(block, texels - b * block), b * points);
  });
}

}  // namespace

std::vector<std::string> stored_codes(const std::vector<std::uint8_t>& codes, std::size_t texels,
                                      std::size_t points) {
  std::vector<std::string> blocks(blocks_of(texels, StoredMaps<3>::block) * points);
  for_each_block(texels, points, [&](std::size_t first, std::size_t some, std::size_t b) {
    std::string bytes(some, '\0');
    for (std::size_t p = 0; p < points; ++p) {
      std::uint8_t before = 0;
      for (std::size_t i = 0; i < some; ++i) {
        const std::uint8_t code = codes[(first + i) * points + p];
        bytes[i] = static_cast<char>(folded(static_cast<std::uint8_t>(code - before)));
        before = code;
      }
      blocks[b + p] = deflated(bytes);
    }
  });
  return blocks;
}

void restore_codes(const std::vector<std::string>& blocks, std::size_t texels, std::size_t points,
                   std::vector<std::uint8_t>& codes, std::vector<std::uint8_t>& least) {
  if (blocks.size() != blocks_of(texels, StoredMaps<3>::block) * points) {
    throw std::runtime_error("blocks of visibility maps are missing");
  }
  // Texels whose codes stay in the processor's cache while all points are written.
  constexpr std::size_t near = 512;
  for_each_block(texels, points, [&](std::size_t first, std::size_t some, std::size_t b) {
    std::vector<std::string> bytes(points, std::string(some, '\0'));
    for (std::size_t p = 0; p < points; ++p) inflate_into(bytes[p], blocks[b + p]);
    std::vector<std::uint8_t> before(points, 0);
    for (std::size_t begin = 0; begin < some; begin += near) {
      const std::size_t end = std::min(begin + near, some);
      for (std::size_t p = 0; p < points; ++p) {
        std::uint8_t code = before[p];
        for (std::size_t i = begin; i < end; ++i) {
          code = static_cast<std::uint8_t>(code + unfolded(static_cast<std::uint8_t>(bytes[p][i])));
          codes[(first + i) * points + p] = code;
          least[first + i] = p == 0 ? code : std::min(least[first + i], code);
        }
        before[p] = code;
      }
    }
  });
}

template <int D>
DirectLight<D>::DirectLight(const SceneTracer<D>& tracer, int volume,
                            const std::vector<LightPoint<D>>& points, const StoredMaps<D>& stored)
    : DirectLight(tracer, volume, points) {
  if (stored.points != points.size()) {
    throw std::runtime_error("visibility maps are of other lights");
  }
  code_range_ = stored.code_range;
  auto maps = std::make_shared<Maps>();
  maps->lattice = stored.lattice;
  maps->has_dark = stored.has_dark;
  const std::size_t active = maps->lattice.active.size();
  for (int side = 0; side < (stored.has_back ? 2 : 1); ++side) {
    maps->codes[side].resize(active * points_.size() + block);
    maps->least[side].assign(active, VisibilityCode::dark);
    restore_codes(stored.codes[side], active, points_.size(), maps->codes[side], maps->least[side]);
  }
  maps_ = std::move(maps);
}

template <int D>
StoredMaps<D> DirectLight<D>::stored() const {
  StoredMaps<D> stored{maps_->lattice, points_.size(),  code_range_,
                       has_back(),     maps_->has_dark, {}};
  for (int side = 0; side < (has_back() ? 2 : 1); ++side) {
    stored.codes[side] =
        stored_codes(maps_->codes[side], stored.lattice.active.size(), points_.size());
  }
  return stored;
}

template DirectLight<2>::DirectLight(const SceneTracer<2>&, int, const std::vector<LightPoint<2>>&,
                                     const StoredMaps<2>&);
template DirectLight<3>::DirectLight(const SceneTracer<3>&, int, const std::vector<LightPoint<3>>&,
                                     const StoredMaps<3>&);
template StoredMaps<2> DirectLight<2>::stored() const;
template StoredMaps<3> DirectLight<3>::stored() const;

}  // namespace leaflight
