// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/packed_numbers.h"

#include <tbb/parallel_for.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace leaflight {
namespace {

constexpr int level = 6, raw = -15, most_memory = 9;
constexpr int bytes_of_number = PackedNumbers::bytes_of_number;

std::runtime_error damaged_block() { return std::runtime_error("a block of numbers is damaged"); }

Bytef* bytes_of(std::string& text) { return reinterpret_cast<Bytef*>(text.data()); }
Bytef* bytes_of(const std::string& text) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
}

// Returns the low bytes of each channel's differences, the middle ones and the high ones. The
// differences have 24 bits at most.
std::vector<std::string> differences(const float* numbers, std::size_t count, int channels,
                                     ShortFloat precision) {
  std::vector<std::string> bytes(bytes_of_number * channels, std::string(count, '\0'));
  std::array<std::uint32_t, 3> before{};
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::uint32_t, 3> codes{};
    for (int c = 0; c < channels; ++c) {
      codes[c] = static_cast<std::uint32_t>(precision.code(numbers[channels * i + c]));
    }
    if (channels == 3) {
      codes[0] -= codes[1];
      codes[2] -= codes[1];
    }
    for (int c = 0; c < channels; ++c) {
      const std::uint32_t difference = folded(codes[c] - before[c]);
      for (int b = 0; b < bytes_of_number; ++b) {
        bytes[bytes_of_number * c + b][i] = static_cast<char>(difference >> 8 * b & 0xff);
      }
    }
    before = codes;
  }
  return bytes;
}

void sum(const std::vector<std::string>& bytes, std::size_t count, int channels,
         ShortFloat precision, float* numbers) {
  std::array<std::uint32_t, 3> codes{};
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < channels; ++c) {
      std::uint32_t difference = 0;
      for (int b = 0; b < bytes_of_number; ++b) {
        const auto byte = static_cast<unsigned char>(bytes[bytes_of_number * c + b][i]);
        difference |= static_cast<std::uint32_t>(byte) << 8 * b;
      }
      codes[c] += unfolded(difference);
    }
    const std::uint32_t green = channels == 3 ? codes[1] : 0;
    for (int c = 0; c < channels; ++c) {
      const std::uint32_t code = c == 1 ? codes[1] : codes[c] + green;
      numbers[channels * i + c] = precision.number(static_cast<std::int32_t>(code));
    }
  }
}

// True if bytes occur so evenly that compression would save less than a twentieth. The low bytes of
// light are such noise, and take no time then.
bool is_noise(const std::string& bytes) {
  constexpr double most_saved = 0.05;
  std::array<std::size_t, 256> counts{};
  for (const char byte : bytes) ++counts[static_cast<unsigned char>(byte)];
  double bits = 0;
  for (const std::size_t count : counts) {
    const auto times = static_cast<double>(count);
    if (count > 0) bits -= times * std::log2(times / static_cast<double>(bytes.size()));
  }
  return bits > (1 - most_saved) * 8 * static_cast<double>(bytes.size());
}

}  // namespace

std::string deflated(const std::string& bytes) {
  if (is_noise(bytes)) return bytes;
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, raw, most_memory, Z_RLE) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string text(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = bytes_of(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = bytes_of(text);
  stream.avail_out = static_cast<uInt>(text.size());
  deflate(&stream, Z_FINISH);
  text.resize(stream.total_out);
  deflateEnd(&stream);
  return text.size() < bytes.size() ? text : bytes;
}

void inflate_into(std::string& bytes, const std::string& text) {
  if (text.size() == bytes.size()) {
    bytes = text;
    return;
  }
  z_stream stream{};
  if (inflateInit2(&stream, raw) != Z_OK) throw std::bad_alloc();
  stream.next_in = bytes_of(text);
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = bytes_of(bytes);
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int state = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (state != Z_STREAM_END || stream.avail_out != 0) throw damaged_block();
}

PackedNumbers::PackedNumbers(const float* numbers, std::size_t count, int channels,
                             ShortFloat precision)
    : blocks_(bytes_of_number * channels * blocks_of(count, block)),
      count_(count),
      channels_(channels),
      precision_(precision) {
  tbb::parallel_for(std::size_t{0}, blocks_of(count, block), [&](std::size_t b) {
    const std::size_t first = b * block, some = std::min(block, count - first);
    const std::vector<std::string> bytes =
        differences(numbers + first * channels, some, channels, precision);
    for (std::size_t p = 0; p < bytes.size(); ++p) {
      blocks_[b * bytes.size() + p] = deflated(bytes[p]);
    }
  });
}

void PackedNumbers::unpack(float* numbers) const {
  const std::size_t parts = bytes_of_number * static_cast<std::size_t>(channels_);
  tbb::parallel_for(std::size_t{0}, blocks_of(count_, block), [&](std::size_t b) {
    const std::size_t first = b * block, some = std::min(block, count_ - first);
    std::vector<std::string> bytes(parts, std::string(some, '\0'));
    for (std::size_t p = 0; p < parts; ++p) inflate_into(bytes[p], blocks_.at(b * parts + p));
    sum(bytes, some, channels_, precision_, numbers + first * channels_);
  });
}

PackedNumbers packed(const std::vector<Vec<3, float>>& colors, ShortFloat precision) {
  return {colors.empty() ? nullptr : &colors[0].x, colors.size(), 3, precision};
}

std::vector<Vec<3, float>> unpacked_colors(const PackedNumbers& numbers) {
  std::vector<Vec<3, float>> colors(numbers.count());
  if (!colors.empty()) numbers.unpack(&colors[0].x);
  return colors;
}

}  // namespace leaflight
