// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.h"

namespace leaflight::fuzz {

// As targets.py has it for the command line.
constexpr std::size_t longest_sentence = 600;

// Ends the program as libFuzzer wishes for what must not be.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

// Calls read(), which may succeed or throw an Error of one sentence. Anything else is a failure.
// Returns true if it succeeded.
template <class Read>
bool accepted(const Read& read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    const std::string text = error.what();
    require(!text.empty() && text.size() < longest_sentence && text.find('\n') == text.npos &&
                text.back() == '.',
            "not a sentence: " + text);
    return false;
  }
}

}  // namespace leaflight::fuzz
