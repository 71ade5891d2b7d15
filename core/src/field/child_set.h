// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace leaflight {

// A set of numbers below 128.
struct ChildSet {
  std::uint64_t low = 0, high = 0;

  bool holds(int i) const { return (i < 64 ? low >> i : high >> (i - 64)) & 1; }
  bool empty() const { return (low | high) == 0; }
  constexpr void insert(int i) { (i < 64 ? low : high) |= std::uint64_t{1} << (i & 63); }
  // Returns the set with n subtracted from each number; drops negative results. 0 < n < 64.
  ChildSet less(int n) const { return {low >> n | high << (64 - n), high >> n}; }
  ChildSet operator|(const ChildSet& o) const { return {low | o.low, high | o.high}; }
  ChildSet operator&(const ChildSet& o) const { return {low & o.low, high & o.high}; }
  ChildSet operator~() const { return {~low, ~high}; }
};

// Returns the indices of the bytes that are at least the limit. N: a multiple of 16, at most 128.
template <std::size_t N>
ChildSet at_least(const std::array<std::uint8_t, N>& bytes, std::uint8_t limit) {
  static_assert(N % 16 == 0 && N <= 128);
  std::array<std::uint64_t, 2> words{};
#if defined(__SSE2__)
  const __m128i least = _mm_set1_epi8(static_cast<char>(limit));
  for (std::size_t i = 0; i < N; i += 16) {
    const __m128i b = _mm_load_si128(reinterpret_cast<const __m128i*>(bytes.data() + i));
    const auto mask = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_max_epu8(b, least), b));
    words[i / 64] |= static_cast<std::uint64_t>(static_cast<unsigned>(mask)) << (i % 64);
  }
#else
  for (std::size_t i = 0; i < N; ++i) {
    words[i / 64] |= static_cast<std::uint64_t>(bytes[i] >= limit) << (i % 64);
  }
#endif
  return {words[0], words[1]};
}

}  // namespace leaflight
