// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <vector>

#include "base/vector.h"

namespace leaflight {

// An axis-parallel box that includes its ends; it is empty until it is extended.
template <int D>
struct Box {
  Vec<D> low{std::numeric_limits<double>::infinity()};
  Vec<D> high{-std::numeric_limits<double>::infinity()};

  void extend(const Vec<D>& p) {
    for (int a = 0; a < D; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  void extend(const Box& other) {
    extend(other.low);
    extend(other.high);
  }
  bool overlaps(const Box& other) const {
    for (int a = 0; a < D; ++a) {
      if (!(high[a] >= other.low[a] && low[a] <= other.high[a])) return false;
    }
    return true;
  }
  std::vector<Vec<D>> corners() const {
    std::vector<Vec<D>> points;
    for (int i = 0; i < 1 << D; ++i) {
      Vec<D> p;
      for (int a = 0; a < D; ++a) p[a] = (i >> a & 1) ? high[a] : low[a];
      points.push_back(p);
    }
    return points;
  }
  double longest_side() const {
    double side = 0;
    for (int a = 0; a < D; ++a) side = std::max(side, high[a] - low[a]);
    return side;
  }
};

}  // namespace leaflight
