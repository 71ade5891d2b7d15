// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/platform.h"

namespace leaflight {

// A set of numbers below a bound, with their ranks, in 12 bytes per 64 possible numbers.
class RankedSet {
 public:
  static constexpr std::int32_t absent = -1;
  static constexpr std::size_t word_bits = 64;

  RankedSet() = default;
  // Makes a set of ascending numbers below the bound.
  RankedSet(std::size_t bound, const std::vector<std::uint32_t>& numbers) : bound_(bound) {
    words_.resize((bound + word_bits - 1) / word_bits);
    before_.resize(words_.size());
    for (const std::uint32_t n : numbers) words_[n / word_bits] |= bit(n);
    std::uint32_t rank = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = rank;
      rank += count(words_[w]);
    }
  }

  std::size_t bound() const { return bound_; }
  // Returns the rank of a number, or absent.
  std::int32_t operator[](std::size_t number) const {
    const std::uint64_t word = words_[number / word_bits], mask = bit(number);
    if (!(word & mask)) return absent;
    return static_cast<std::int32_t>(before_[number / word_bits] + count(word & (mask - 1)));
  }
  // Returns the ranks of a number and of the next one.
  std::array<std::int32_t, 2> two_from(std::size_t number) const {
    const std::size_t place = number % word_bits;
    if (place == word_bits - 1) return {(*this)[number], (*this)[number + 1]};
    const std::uint64_t word = words_[number / word_bits];
    const auto has = static_cast<std::int32_t>(word >> place & 3);
    if (has == 0) return {absent, absent};
    const auto rank =
        static_cast<std::int32_t>(before_[number / word_bits] + count(word & (bit(number) - 1)));
    return {has & 1 ? rank : absent, has & 2 ? rank + (has & 1) : absent};
  }

 private:
  static std::uint64_t bit(std::size_t number) { return std::uint64_t{1} << (number % word_bits); }
  static std::uint32_t count(std::uint64_t word) {
    return static_cast<std::uint32_t>(count_ones(word));
  }

  std::size_t bound_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  // count of the set's numbers before each word
};

}  // namespace leaflight
