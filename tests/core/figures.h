// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "agreement.h"

namespace leaflight::test {

// Returns the number of trials of a case: usually `usual`, fewer in sanitized builds. It is
// `large`, as in docs/validation/numerics.md, if validation/run numerics asks for it.
inline std::int64_t trials(std::int64_t usual, std::int64_t large) {
  const char* wanted = std::getenv("LEAFLIGHT_NUMERICS");
  if (wanted && std::string(wanted) == "large") return large;
  return sanitized ? std::max<std::int64_t>(2, usual / 32) : usual;
}

// Prints a measured figure for docs/validation/numerics.md.
template <class Number>
void figure(const std::string& name, const Number& number) {
  std::cout << "    " << name << ": " << number << '\n';
}

}  // namespace leaflight::test
