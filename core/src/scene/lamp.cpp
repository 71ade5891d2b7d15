// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/lamp.h"

#include "base/sampling.h"

namespace leaflight {

template <int D>
Vec<D> AreaLight<D>::point(const std::array<double, 2>& u) const {
  std::array<double, 2> at = u;
  if (ellipse) {
    const Vec<2> disc = sample_disc(u);
    at = {0.5 + 0.5 * disc.x, 0.5 + 0.5 * disc.y};
  }
  Vec<D> p = corner;
  for (int i = 0; i < D - 1; ++i) p += edges[i] * at[i];
  return p;
}

template <int D>
double AreaLight<D>::area() const {
  return scaled_normal(edges).length() * (ellipse ? pi / 4 : 1);
}

template struct AreaLight<2>;
template struct AreaLight<3>;

}  // namespace leaflight
