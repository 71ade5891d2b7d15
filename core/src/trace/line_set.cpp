// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/line_set.h"

#include <algorithm>
#include <cmath>

namespace leaflight {
namespace {

// Returns the axis of the b-th tracks.
template <int D>
int across(int axis, int b) {
  return b < axis ? b : b + 1;
}

}  // namespace

template <int D>
LineSet<D> parallel_lines(const TexelLattice<D>& lattice, const Vec<D>& direction, int spacing,
                          const std::array<double, 2>& offset) {
  LineSet<D> set;
  for (int a = 1; a < D; ++a) {
    if (std::abs(direction[a]) > std::abs(direction[set.axis])) set.axis = a;
  }
  set.step = direction[set.axis] < 0 ? -1 : 1;
  set.high = lattice.resolution[set.axis] - 1;
  for (int b = 0; b < D - 1; ++b) {
    const double slope = direction[across<D>(set.axis, b)] / direction[set.axis];
    const double last = lattice.resolution[across<D>(set.axis, b)] - 1, shift = slope * set.high;
    const int first = static_cast<int>(std::floor(-std::max(0.0, shift) / spacing)) - 1;
    const int end = static_cast<int>(std::ceil((last - std::min(0.0, shift)) / spacing));
    for (int i = first; i <= end; ++i) set.tracks[b].push_back({(i + offset[b]) * spacing, slope});
  }
  return set;
}

template <int D>
std::vector<LineSet<D>> lines_from(const TexelLattice<D>& lattice, const Vec<D>& point,
                                   const std::array<double, 2>& offset) {
  std::vector<LineSet<D>> sets;
  for (int axis = 0; axis < D; ++axis) {
    for (const int sense : {1, -1}) {
      const double end = lattice.resolution[axis] - 1;
      // Distances of the farthest and the nearest plane along the axis.
      const double far = sense > 0 ? end - point[axis] : point[axis];
      const double near = std::max(sense > 0 ? -point[axis] : point[axis] - end, 1e-9);
      if (!(far > near)) continue;
      LineSet<D> set;
      set.axis = axis;
      set.step = sense;
      set.from = point[axis];
      set.low = sense > 0 ? std::max(0.0, point[axis]) : 0;
      set.high = sense > 0 ? end : std::min(end, point[axis]);
      set.crowded = true;
      const double spacing = 1 / std::max(far, 1.0);
      for (int b = 0; b < D - 1; ++b) {
        const int other = across<D>(axis, b);
        const double before = -point[other];
        const double behind = lattice.resolution[other] - 1 - point[other];
        // Slopes are limited to 45 degrees; lines of another axis cover the rest.
        const double least = std::max(-1.0, std::min(before / near, before / far));
        const double most = std::min(1.0, std::max(behind / near, behind / far));
        const int last = static_cast<int>(std::ceil(most / spacing - offset[b]));
        for (int i = static_cast<int>(std::floor(least / spacing - offset[b])); i <= last; ++i) {
          const double slope = (i + offset[b]) * spacing;
          if (!(slope >= -1 && slope < 1)) continue;
          set.tracks[b].push_back({point[other] - slope * sense * point[axis], slope * sense});
        }
      }
      if (set.lines() > 0) sets.push_back(std::move(set));
    }
  }
  return sets;
}

template LineSet<2> parallel_lines<2>(const TexelLattice<2>&, const Vec<2>&, int,
                                      const std::array<double, 2>&);
template LineSet<3> parallel_lines<3>(const TexelLattice<3>&, const Vec<3>&, int,
                                      const std::array<double, 2>&);
template std::vector<LineSet<2>> lines_from<2>(const TexelLattice<2>&, const Vec<2>&,
                                               const std::array<double, 2>&);
template std::vector<LineSet<3>> lines_from<3>(const TexelLattice<3>&, const Vec<3>&,
                                               const std::array<double, 2>&);

}  // namespace leaflight
