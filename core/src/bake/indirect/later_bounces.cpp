// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/later_bounces.h"

#include <algorithm>

namespace leaflight {
namespace {

// Upper bound on the ratio of successive bounces. For high albedos, noise may raise the estimate
// above 1.
constexpr Real most_bounced = Real(0.8);

Rgb mean_of(const std::vector<Rgb>& light) {
  Imath::V3d sum(0);
  for (const Rgb& one : light) sum += Imath::V3d(one);
  return light.empty() ? Rgb(0) : Rgb(sum / static_cast<double>(light.size()));
}

}  // namespace

Rgb later_bounces(const std::vector<Rgb>& before, const std::vector<Rgb>& last) {
  const Rgb first = mean_of(before), second = mean_of(last);
  Rgb later(0);
  for (int i = 0; i < 3; ++i) {
    if (!(first[i] > 0)) continue;
    const Real ratio = std::min(second[i] / first[i], most_bounced);
    later[i] = ratio / (1 - ratio);
  }
  return later;
}

}  // namespace leaflight
