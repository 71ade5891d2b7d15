// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/affine.h"

namespace leaflight {

template <>
double determinant<2>(const Affine<2>& m) {
  return m.column[0].cross(m.column[1]);
}

template <>
double determinant<3>(const Affine<3>& m) {
  return m.column[0].dot(m.column[1].cross(m.column[2]));
}

template <>
Affine<2> inverse<2>(const Affine<2>& m) {
  const double d = determinant(m);
  Affine<2> r;
  r.column[0] = Vec<2>(m.column[1].y, -m.column[0].y) / d;
  r.column[1] = Vec<2>(-m.column[1].x, m.column[0].x) / d;
  r.origin = -r.vector(m.origin);
  return r;
}

template <>
Affine<3> inverse<3>(const Affine<3>& m) {
  const double d = determinant(m);
  const std::array<Vec3, 3> rows{m.column[1].cross(m.column[2]) / d,
                                 m.column[2].cross(m.column[0]) / d,
                                 m.column[0].cross(m.column[1]) / d};
  Affine<3> r;
  for (int a = 0; a < 3; ++a) r.column[a] = Vec3(rows[0][a], rows[1][a], rows[2][a]);
  r.origin = -r.vector(m.origin);
  return r;
}

}  // namespace leaflight
