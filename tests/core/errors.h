// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"

namespace leaflight::test {

// Expects a call to throw an Error that contains these words.
template <class Call>
void expect_refused(const std::string& words, Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    return;
  }
  ADD_FAILURE() << "no error: " << words;
}

}  // namespace leaflight::test
