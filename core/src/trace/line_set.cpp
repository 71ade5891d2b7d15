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
  const double planes = lattice.resolution[set.axis] - 1;
  for (int b = 0; b < D - 1; ++b) {
    const double slope = direction[across<D>(set.axis, b)] / direction[set.axis];
    const double last = lattice.resolution[across<D>(set.axis, b)] - 1, shift = slope * planes;
    const int first = static_cast<int>(std::floor(-std::max(0.0, shift) / spacing)) - 1;
    const int end = static_cast<int>(std::ceil((last - std::min(0.0, shift)) / spacing));
    for (int i = first; i <= end; ++i) set.tracks[b].push_back({(i + offset[b]) * spacing, slope});
  }
  return set;
}

template LineSet<2> parallel_lines<2>(const TexelLattice<2>&, const Vec<2>&, int,
                                      const std::array<double, 2>&);
template LineSet<3> parallel_lines<3>(const TexelLattice<3>&, const Vec<3>&, int,
                                      const std::array<double, 2>&);

}  // namespace leaflight
