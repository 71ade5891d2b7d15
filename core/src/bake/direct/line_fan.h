// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace leaflight {

// A position between two of several regular points.
struct Between {
  int below = 0;
  float part = 0;
};

inline Between between(double x, int count) {
  const double clamped = std::clamp(x, 0.0, static_cast<double>(count - 1));
  const int below = std::min(static_cast<int>(clamped), std::max(0, count - 2));
  return {below, static_cast<float>(clamped - below)};
}

// Lines across one axis of a plane. At distance t from the light, line i is at offset + slope t + i
// spacing(t).
struct LineFan {
  bool parallel = false;
  double offset = 0, slope = 0;
  double step = 1;  // between lines: in slopes, or in coordinates for parallel lines
  int first = 0, count = 1;
  double last_voxel = 0;  // along the axis

  double spacing(double t) const { return parallel ? step : step * t; }
  double origin(double t) const { return offset + slope * t; }
  double at(int i, double t) const { return origin(t) + (first + i) * spacing(t); }

  // Makes room for all lines that are in the box at some distance from t to `end`, plus one
  // neighbor on each side.
  void cover(double t, double end) {
    double low = std::numeric_limits<double>::infinity(),
           high = -std::numeric_limits<double>::infinity();
    for (const double s : {t, end}) {
      const double width = parallel ? 1 : std::max(s, 1e-9);
      low = std::min(low, -origin(s) / width);
      high = std::max(high, (last_voxel - origin(s)) / width);
    }
    if (!parallel) {
      low = std::max(low, -1.0);
      high = std::min(high, 1.0);
    }
    first = static_cast<int>(std::floor(low / step)) - 1;
    count = std::max(0, static_cast<int>(std::ceil(high / step)) + 2 - first);
  }
};

}  // namespace leaflight
