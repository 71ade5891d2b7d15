// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/progress.h"

namespace leaflight {

// Calls body(begin, end) over pieces of [0, n) until the progress is cancelled. `work`: progress of
// one item. Throws Cancelled.
template <class Body>
void parallel_range(std::size_t n, std::size_t grain, double work, Progress& progress, Body body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain),
      [&](const auto& range) {
        if (progress.cancelled()) return;
        body(range.begin(), range.end());
        progress.advance(work * static_cast<double>(range.size()));
      },
      tbb::simple_partitioner{});
  progress.check();
}

// Calls body(i) for each i of [0, n), in pieces of `grain`, until the progress is cancelled. Throws
// Cancelled.
template <class Body>
void parallel_each(std::size_t n, std::size_t grain, Progress& progress, Body body) {
  parallel_range(n, grain, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

// Calls body(i) for each i of [0, n), in parallel.
template <class Body>
void parallel_each(std::size_t n, Body body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

}  // namespace leaflight
