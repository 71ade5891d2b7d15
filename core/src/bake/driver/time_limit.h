// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "bake/plan/plan.h"

namespace leaflight {

// The time since a bake began, and its limit.
class TimeLimit {
 public:
  // `limit` in seconds; 0: none. `clock`: returns seconds since any fixed time; null: a steady
  // clock.
  TimeLimit(double limit, std::function<double()> clock)
      : limit_(limit), clock_(clock ? std::move(clock) : passing), began_(clock_()) {}

  bool is_given() const { return limit_ > 0; }
  double seconds() const { return clock_() - began_; }
  // True if a step of this duration would end too late.
  bool is_over(double seconds_to_come) const {
    return is_given() && seconds() + seconds_to_come > limit_;
  }

 private:
  static double passing() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  double limit_;
  std::function<double()> clock_;
  double began_;
};

// Describes finer texels that were skipped for lack of time. `resolution`: of the baked texels.
template <int D>
SkippedPass finer_texels(const Index<D>& resolution) {
  std::string texels;
  for (const int along : resolution)
    texels += (texels.empty() ? "" : " x ") + std::to_string(along);
  return {"finer texels", "to end in time, there are only " + texels + " texels"};
}
inline SkippedPass finer_walls() { return {"finer walls", "the time has no room for finer walls"}; }

}  // namespace leaflight
