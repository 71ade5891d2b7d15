// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>
#include <type_traits>

namespace leaflight {

// The type of radiometric quantities, in single precision. Geometry always uses double, because the
// sign of h - c defines an isosurface. The `double` preset measures the cost of single precision.
#ifdef LEAFLIGHT_DOUBLE
using Real = double;
#else
using Real = float;
#endif

template <int D, class T = double>
using Vec = std::conditional_t<D == 2, Imath::Vec2<T>, Imath::Vec3<T>>;

// The cast prevents deduction of D from the array's std::size_t.
template <int D>
using Index = std::array<int, static_cast<std::size_t>(D)>;

using Vec3 = Vec<3>;
using Rgb = Imath::Vec3<Real>;

template <int D>
Vec<D> to_vector(const Index<D>& index) {
  Vec<D> v;
  for (int a = 0; a < D; ++a) v[a] = index[a];
  return v;
}

inline Real largest(const Rgb& c) { return std::max(c.x, std::max(c.y, c.z)); }
inline Real average(const Rgb& c) { return (c.x + c.y + c.z) / 3; }

}  // namespace leaflight
