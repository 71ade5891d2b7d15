// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Scrambles by Owen's method, with a hash in which a bit depends only on lower bits (Laine and
// Karras 2011, constants of Burley 2020).
inline std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  x = reverse_bits(x);
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return reverse_bits(x);
}

// Returns a point of an Owen-scrambled Sobol (0,2)-sequence. Different seeds give independent,
// mutually shuffled sequences, so that pairs of dimensions can be padded (Burley 2020).
inline std::array<double, 2> sobol_point(std::uint32_t index, std::uint64_t seed) {
  const auto low = static_cast<std::uint32_t>(seed);
  const auto high = static_cast<std::uint32_t>(seed >> 32);
  index = owen_scramble(index, low ^ 0xa511e9b3u);
  std::uint32_t x = reverse_bits(index);
  // Apply the second dimension's generator matrix, Pascal's triangle modulo 2, in five steps (Ahmed
  // 2024).
  std::uint32_t y = x ^ (x << 16);
  y ^= (y & 0x00ff00ffu) << 8;
  y ^= (y & 0x0f0f0f0fu) << 4;
  y ^= (y & 0x33333333u) << 2;
  y ^= (y & 0x55555555u) << 1;
  x = owen_scramble(x, low * 0x9e3779b9u + high);
  y = owen_scramble(y, high * 0x85ebca6bu + low);
  return {x * 0x1p-32, y * 0x1p-32};
}

}  // namespace leaflight
