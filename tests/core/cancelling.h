// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "base/progress.h"

namespace leaflight::test {

// Runs work(progress), which must not end by itself, and cancels it from another thread once it has
// made some progress. Fails unless it throws Cancelled; returns the seconds from the request to the
// end.
template <class Work>
double seconds_to_cancel(Work work) {
  using Clock = std::chrono::steady_clock;
  Progress progress;
  std::atomic<bool> ended{false};
  Clock::time_point asked;
  std::thread canceller([&] {
    while (progress.fraction() == 0 && !ended) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    asked = Clock::now();
    progress.cancel();
  });
  EXPECT_THROW(work(progress), Cancelled);
  const Clock::time_point end = Clock::now();
  ended = true;
  canceller.join();
  return std::chrono::duration<double>(end - asked).count();
}

}  // namespace leaflight::test
