// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/short_float.h"

namespace leaflight {

// Maps differences of unsigned numbers that are near zero, on either side, to small numbers.
template <class Unsigned>
Unsigned folded(Unsigned difference) {
  const bool is_negative = difference >> (8 * sizeof(Unsigned) - 1);
  return static_cast<Unsigned>(difference << 1 ^ (is_negative ? ~Unsigned(0) : Unsigned(0)));
}
template <class Unsigned>
Unsigned unfolded(Unsigned folded) {
  return static_cast<Unsigned>(folded >> 1 ^ (folded & 1 ? ~Unsigned(0) : Unsigned(0)));
}

// Compresses bytes (zlib), unless that saves little. The strategy takes runs of a byte, and
// otherwise only how often bytes occur: longer matches are rare in noise, and the search for them
// is slow.
std::string deflated(const std::string& bytes);
// Restores `bytes`, which must have its size. Throws std::runtime_error if the text is damaged.
void inflate_into(std::string& bytes, const std::string& text);

// Numbers or colors as codes of ShortFloat, compressed in parallel. A number is stored as its
// difference from the one before, and red and blue as differences from green. For each block of
// items and each channel, low, middle and high bytes are compressed apart.
class PackedNumbers {
 public:
  static constexpr std::size_t block = std::size_t{1} << 16;  // items
  static constexpr int bytes_of_number = 3;                   // of a difference of codes

  PackedNumbers() = default;
  // Packs `count` items of 1 or 3 channels. The numbers are rounded.
  PackedNumbers(const float* numbers, std::size_t count, int channels, ShortFloat precision);
  // Takes the parts of other packed numbers.
  PackedNumbers(std::vector<std::string> blocks, std::size_t count, int channels,
                ShortFloat precision)
      : blocks_(std::move(blocks)), count_(count), channels_(channels), precision_(precision) {}

  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  int channels() const { return channels_; }
  ShortFloat precision() const { return precision_; }
  const std::vector<std::string>& blocks() const { return blocks_; }
  // Writes count() times channels() numbers. Throws
  // std::runtime_error if blocks are damaged.
  void unpack(float* numbers) const;

 private:
  std::vector<std::string> blocks_;
  std::size_t count_ = 0;
  int channels_ = 1;
  ShortFloat precision_;
};

inline std::size_t blocks_of(std::size_t count, std::size_t block) {
  return (count + block - 1) / block;
}

PackedNumbers packed(const std::vector<Vec<3, float>>& colors, ShortFloat precision);
std::vector<Vec<3, float>> unpacked_colors(const PackedNumbers& numbers);

}  // namespace leaflight
