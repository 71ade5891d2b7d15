// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Imath/half.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/vector.h"

namespace leaflight {

// Codes of numbers of half precision without the last `dropped` of its ten bits. Codes are in the
// order of their numbers. Numbers above the largest half are rounded to it.
struct ShortHalf {
  int dropped = 0;

  std::int16_t code(float number) const {
    const std::uint32_t bits = Imath::half(number).bits();
    const std::uint32_t size = bits & 0x7fff;
    if (size > infinite) return static_cast<std::int16_t>(infinite >> dropped);  // NaN
    const std::uint32_t middle = dropped > 0 ? 1u << (dropped - 1) : 0;
    const auto code = static_cast<std::int16_t>(std::min(size + middle, infinite - 1) >> dropped);
    return bits & 0x8000 ? static_cast<std::int16_t>(-code) : code;
  }
  float number(std::int16_t code) const {
    const std::uint32_t size = static_cast<std::uint32_t>(code < 0 ? -code : code) << dropped;
    if (size >= infinite) return std::numeric_limits<float>::quiet_NaN();
    float number;
    if (size < least_normal) {
      number = static_cast<float>(size) * 0x1p-24f;
    } else {
      // The exponents of floats are greater by 112.
      const std::uint32_t bits = (size << 13) + (112u << 23);
      std::memcpy(&number, &bits, sizeof number);
    }
    return code < 0 ? -number : number;
  }
  float rounded(float value) const { return number(code(value)); }
  Vec<3, float> rounded(const Vec<3, float>& v) const {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
  }

 private:
  static constexpr std::uint32_t infinite = 0x7c00, least_normal = 0x400;
};

}  // namespace leaflight
