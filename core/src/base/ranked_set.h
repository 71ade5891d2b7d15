// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/parallel_for.h>

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

  static std::size_t words_for(std::size_t bound) { return (bound + word_bits - 1) / word_bits; }

  RankedSet() = default;
  // Makes a set of ascending numbers below the bound.
  RankedSet(std::size_t bound, const std::vector<std::uint32_t>& numbers)
      : bound_(bound), words_(words_for(bound)) {
    for (const std::uint32_t n : numbers) words_[n / word_bits] |= bit(n);
    count_before();
  }
  // Makes a set from one bit for each number, the lowest first.
  RankedSet(std::size_t bound, std::vector<std::uint64_t> words)
      : bound_(bound), words_(std::move(words)) {
    count_before();
  }

  std::size_t bound() const { return bound_; }
  // Returns the numbers in the set, ascending.
  std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> numbers(words_.empty() ? 0 : before_.back() + count(words_.back()));
    tbb::parallel_for(std::size_t{0}, words_.size(), [&](std::size_t w) {
      std::uint32_t rank = before_[w];
      for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
        numbers[rank++] = static_cast<std::uint32_t>(w * word_bits + lowest_bit(word));
      }
    });
    return numbers;
  }
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
  void count_before() {
    before_.resize(words_.size());
    std::uint32_t rank = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = rank;
      rank += count(words_[w]);
    }
  }
  static std::uint64_t bit(std::size_t number) { return std::uint64_t{1} << (number % word_bits); }
  static std::uint32_t count(std::uint64_t word) {
    return static_cast<std::uint32_t>(count_ones(word));
  }

  std::size_t bound_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  // count of the set's numbers before each word
};

}  // namespace leaflight
