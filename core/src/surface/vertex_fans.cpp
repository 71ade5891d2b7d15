// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/vertex_fans.h"

#include <numeric>

namespace leaflight {

VertexFans::VertexFans(std::size_t vertices,
                       const std::vector<std::array<std::int32_t, 3>>& triangles)
    : first_(vertices + 1, 0), others_(3 * triangles.size()) {
  for (const auto& t : triangles) {
    for (const std::int32_t v : t) ++first_[v + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& t : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      others_[next[t[corner]]++] = {t[(corner + 1) % 3], t[(corner + 2) % 3]};
    }
  }
}

}  // namespace leaflight
