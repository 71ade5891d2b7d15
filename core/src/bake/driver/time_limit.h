// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "bake/plan/plan.h"

namespace leaflight {

// The time since a bake began, and how much of it there may be.
class TimeLimit {
 public:
  // `limit` [s]; 0: none. `clock`: seconds since any time; null: those that pass.
  TimeLimit(double limit, std::function<double()> clock)
      : limit_(limit), clock_(clock ? std::move(clock) : passing), began_(clock_()) {}

  bool is_given() const { return limit_ > 0; }
  double seconds() const { return clock_() - began_; }
  // Whether something that takes so long ends too late.
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

// What there is no time for. `resolution`: of the texels that there is time for.
template <int D>
SkippedPass finer_texels(const Index<D>& resolution) {
  std::string texels;
  for (const int along : resolution)
    texels += (texels.empty() ? "" : " x ") + std::to_string(along);
  return {"finer texels", "the light of " + texels + " is what the time has room for"};
}
inline SkippedPass finer_walls() {
  return {"finer walls", "the walls have the light that the time has room for"};
}

}  // namespace leaflight
