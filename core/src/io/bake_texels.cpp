// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/bake_texels.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "base/packed_numbers.h"

namespace leaflight {
namespace {

constexpr std::array<char, 16> texels_mark{'L', 'e',    'a', 'f', 'l', 'i', 'g', 'h',
                                           't', '\x1a', 't', 'e', 'x', 'e', 'l', '1'};
constexpr std::size_t end_size = sizeof(std::uint64_t) + texels_mark.size();
// 64-bit words of a block of a lattice.
constexpr std::size_t block_of_words = 1 << 14;

// The arrays of a volume that not every bake has.
enum Has : std::uint32_t {
  back = 1,
  radiance = 2,
  radiance_back = 4,
  unfiltered = 8,
  maps = 16,
  layers = 32
};

std::runtime_error damaged_texels() { return std::runtime_error("its texels are damaged"); }

template <class Value>
void put(std::ostream& stream, const Value& value) {
  stream.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_blocks(std::ostream& stream, const std::vector<std::string>& blocks) {
  for (const std::string& block : blocks) {
    put(stream, static_cast<std::uint32_t>(block.size()));
  }
  for (const std::string& block : blocks) {
    stream.write(block.data(), static_cast<std::streamsize>(block.size()));
  }
}

void put_set(std::ostream& stream, std::size_t bound, const std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint64_t> words(RankedSet::words_for(bound));
  for (const std::uint32_t n : numbers) {
    words[n / RankedSet::word_bits] |= std::uint64_t{1} << (n % RankedSet::word_bits);
  }
  std::vector<std::string> blocks(blocks_of(words.size(), block_of_words));
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    const std::size_t first = b * block_of_words,
                      some = std::min(block_of_words, words.size() - first);
    blocks[b] =
        deflated(std::string(reinterpret_cast<const char*>(&words[first]), some * sizeof words[0]));
  });
  put_blocks(stream, blocks);
}

void put_lattice(std::ostream& stream, const TexelLattice<3>& lattice) {
  for (const int n : lattice.resolution) put(stream, static_cast<std::int32_t>(n));
  put_set(stream, lattice.texels(), lattice.slot.numbers());
}

void put_layers(std::ostream& stream, const TexelLattice<3>& lattice) {
  put_set(stream, lattice.texels(), lattice.capped.numbers());
  put(stream, lattice.lowest_layer);
  put(stream, lattice.layer_step);
}

void put_numbers(std::ostream& stream, const PackedNumbers& numbers) {
  put(stream, static_cast<std::int32_t>(numbers.precision().dropped));
  put_blocks(stream, numbers.blocks());
}

void put_maps(std::ostream& stream, const StoredMaps<3>& maps) {
  put_lattice(stream, maps.lattice);
  put(stream, static_cast<std::uint32_t>(maps.points));
  put(stream, maps.code_range.min);
  put(stream, maps.code_range.max);
  put(stream, static_cast<std::uint8_t>(maps.has_back));
  put(stream, static_cast<std::uint8_t>(maps.has_dark));
  for (int side = 0; side < (maps.has_back ? 2 : 1); ++side) put_blocks(stream, maps.codes[side]);
}

void put_volume(std::ostream& stream, const RadianceGrid<3>& grid) {
  const auto put_light = [&](const std::vector<Vec<3, float>>& light) {
    put_numbers(stream, packed(light, light_precision));
  };
  std::uint32_t has = 0;
  if (grid.has_back()) has |= Has::back;
  if (!grid.derives_radiance(false)) has |= Has::radiance;
  if (grid.has_back() && !grid.derives_radiance(true)) has |= Has::radiance_back;
  if (!grid.unfiltered.lattice.active.empty()) has |= Has::unfiltered;
  if (grid.lattice.has_layers()) has |= Has::layers;
  if (grid.direct) has |= Has::maps;
  put(stream, has);
  put_lattice(stream, grid.lattice);
  if (has & Has::layers) put_layers(stream, grid.lattice);
  put_light(grid.radiance_indirect);
  if (has & Has::back) put_light(grid.radiance_back_indirect);
  if (has & Has::radiance) put_light(grid.radiance);
  if (has & Has::radiance_back) put_light(grid.radiance_back);
  put_numbers(stream, {grid.radiance_error.data(), grid.radiance_error.size(), 1, error_precision});
  if (has & Has::unfiltered) {
    put_lattice(stream, grid.unfiltered.lattice);
    if (has & Has::layers) put_layers(stream, grid.unfiltered.lattice);
    for (int side = 0; side < (has & Has::back ? 2 : 1); ++side) {
      put_numbers(stream, grid.unfiltered.sides[side]);
    }
  }
  if (has & Has::maps) put_maps(stream, grid.direct->stored());
}

}  // namespace

void write_texels(std::ostream& stream, const std::vector<const RadianceGrid<3>*>& grids,
                  const std::vector<std::vector<std::uint64_t>>& runs) {
  const auto begin = static_cast<std::uint64_t>(stream.tellp());
  put(stream, static_cast<std::uint32_t>(grids.size()));
  for (std::size_t v = 0; v < grids.size(); ++v) {
    put(stream, static_cast<std::uint32_t>(runs[v].size()));
    for (const std::uint64_t position : runs[v]) put(stream, position);
    put_volume(stream, *grids[v]);
  }
  end_texels(stream, begin);
}

void end_texels(std::ostream& stream, std::uint64_t begin) {
  put(stream, begin);
  put(stream, texels_mark);
}

std::optional<TexelReader> TexelReader::open(const std::filesystem::path& path,
                                             std::uint64_t length) {
  if (length < end_size) return {};
  TexelReader reader;
  reader.stream_.exceptions(std::ios::failbit | std::ios::badbit);
  reader.stream_.open(path, std::ios::binary);
  reader.stream_.seekg(static_cast<std::streamoff>(length - end_size));
  reader.left_ = end_size;
  const auto begin = reader.value<std::uint64_t>();
  if (reader.value<std::array<char, 16>>() != texels_mark) return {};
  if (begin > length - end_size) throw damaged_texels();
  reader.stream_.seekg(static_cast<std::streamoff>(begin));
  reader.left_ = length - end_size - begin;
  reader.volumes_ = reader.value<std::uint32_t>();
  return reader;
}

template <class Value>
Value TexelReader::value() {
  const std::string text = bytes(sizeof(Value));
  Value value;
  std::memcpy(&value, text.data(), sizeof value);
  return value;
}

std::string TexelReader::bytes(std::uint64_t count) {
  if (count > left_) throw damaged_texels();
  left_ -= count;
  std::string text(count, '\0');
  stream_.read(text.data(), static_cast<std::streamsize>(count));
  return text;
}

std::vector<std::string> TexelReader::blocks(std::uint64_t count) {
  if (count > left_) throw damaged_texels();
  const std::string sizes = bytes(count * sizeof(std::uint32_t));
  std::vector<std::string> blocks(count);
  for (std::size_t b = 0; b < count; ++b) {
    std::uint32_t size = 0;
    std::memcpy(&size, sizes.data() + b * sizeof size, sizeof size);
    blocks[b] = bytes(size);
  }
  return blocks;
}

RankedSet TexelReader::set(std::size_t bound) {
  std::vector<std::uint64_t> words(RankedSet::words_for(bound));
  const std::vector<std::string> packed = blocks(blocks_of(words.size(), block_of_words));
  tbb::parallel_for(std::size_t{0}, packed.size(), [&](std::size_t b) {
    const std::size_t first = b * block_of_words,
                      some = std::min(block_of_words, words.size() - first);
    std::string part(some * sizeof words[0], '\0');
    inflate_into(part, packed[b]);
    std::memcpy(&words[first], part.data(), part.size());
  });
  // There are no texels beyond the last.
  const std::size_t last = bound % RankedSet::word_bits;
  if (last > 0 && words.back() >> last != 0) throw damaged_texels();
  return {bound, std::move(words)};
}

TexelLattice<3> TexelReader::lattice(const Index<3>& dims, bool layered) {
  Index<3> resolution;
  for (int& n : resolution) n = value<std::int32_t>();
  check_resolution<3>(resolution);
  TexelLattice<3> lattice = inactive_lattice<3>(dims, resolution);
  lattice.activate(set(lattice.texels()));
  if (layered) {
    const std::vector<std::uint32_t> capped = set(lattice.texels()).numbers();
    for (const std::uint32_t number : capped) {
      if (lattice.slot[number] == RankedSet::absent) throw damaged_texels();
    }
    const auto low = value<double>(), step = value<double>();
    if (!(std::isfinite(low) && step > 0)) throw damaged_texels();
    lattice.add_layers(capped, low, low + step * TexelLattice<3>::layers);
  }
  return lattice;
}

PackedNumbers TexelReader::numbers(std::size_t count, int channels) {
  const ShortFloat precision{value<std::int32_t>()};
  if (precision.dropped < 0 || precision.dropped > 9) throw damaged_texels();
  const std::size_t parts = PackedNumbers::bytes_of_number * static_cast<std::size_t>(channels);
  return {blocks(parts * blocks_of(count, PackedNumbers::block)), count, channels, precision};
}

std::shared_ptr<const StoredMaps<3>> TexelReader::maps(const Index<3>& dims) {
  auto maps = std::make_shared<StoredMaps<3>>();
  maps->lattice = lattice(dims, false);
  maps->points = value<std::uint32_t>();
  maps->code_range.min = value<double>();
  maps->code_range.max = value<double>();
  maps->has_back = value<std::uint8_t>() != 0;
  maps->has_dark = value<std::uint8_t>() != 0;
  const std::size_t blocks_of_texels = blocks_of(maps->lattice.active.size(), StoredMaps<3>::block);
  for (int side = 0; side < (maps->has_back ? 2 : 1); ++side) {
    maps->codes[side] = blocks(blocks_of_texels * maps->points);
  }
  return maps;
}

std::vector<std::uint64_t> TexelReader::runs() {
  const auto count = value<std::uint32_t>();
  const std::string text = bytes(count * sizeof(std::uint64_t));
  std::vector<std::uint64_t> runs(count);
  if (count > 0) std::memcpy(runs.data(), text.data(), text.size());
  return runs;
}

RadianceGrid<3> TexelReader::grid(const Index<3>& dims) {
  const auto has = value<std::uint32_t>();
  RadianceGrid<3> grid;
  const bool layered = (has & Has::layers) != 0;
  grid.lattice = lattice(dims, layered);
  const std::size_t count = grid.texels();
  const auto light = [&] { return unpacked_colors(numbers(count, 3)); };
  grid.radiance_indirect = light();
  if (has & Has::back) grid.radiance_back_indirect = light();
  if (has & Has::radiance) grid.radiance = light();
  if (has & Has::radiance_back) grid.radiance_back = light();
  grid.radiance_error.resize(count);
  numbers(count, 1).unpack(grid.radiance_error.data());
  if (has & Has::unfiltered) {
    TexelLattice<3>& own = grid.unfiltered.lattice;
    own = lattice(dims, layered);
    for (int side = 0; side < (has & Has::back ? 2 : 1); ++side) {
      grid.unfiltered.sides[side] = numbers(own.active.size(), 3);
    }
  }
  if (has & Has::maps) grid.maps = maps(dims);
  return grid;
}

}  // namespace leaflight
