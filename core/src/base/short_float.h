// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/vector.h"

namespace leaflight {

// Codes of 20 bits for floats with the mantissa of a half, without the last `dropped` of its ten
// bits. The exponents are those of floats, so dim light is as precise as bright light. Codes are in
// the order of their numbers. Infinity becomes the largest number.
struct ShortFloat {
  int dropped = 0;

  std::int32_t code(float number) const {
    std::uint32_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    const std::uint32_t size = bits & 0x7fffffff;
    if (size > infinite) return static_cast<std::int32_t>(infinite >> shift());  // NaN
    const std::uint32_t middle = 1u << (shift() - 1), largest = infinite - 1;
    const auto code = static_cast<std::int32_t>(std::min(size + middle, largest) >> shift());
    return size != bits ? -code : code;
  }
  float number(std::int32_t code) const {
    const auto bits = static_cast<std::uint32_t>(code);
    const std::uint32_t size = (code < 0 ? 0 - bits : bits) << shift();
    if (size >= infinite) return std::numeric_limits<float>::quiet_NaN();
    float number;
    std::memcpy(&number, &size, sizeof number);
    return code < 0 ? -number : number;
  }
  float rounded(float value) const { return number(code(value)); }
  Vec<3, float> rounded(const Vec<3, float>& v) const {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
  }

 private:
  static constexpr std::uint32_t infinite = 0x7f800000;

  // Floats have 13 bits more than halves.
  int shift() const { return 13 + dropped; }
};

}  // namespace leaflight
