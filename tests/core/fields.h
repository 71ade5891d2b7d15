// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "base/random.h"
#include "field/field.h"

namespace leaflight::test {

template <int D>
Affine<D> unit_cube(int n) {
  Affine<D> m;
  for (int a = 0; a < D; ++a) {
    m.column[a] = Vec<D>(0.0);
    m.column[a][a] = 1.0 / (n - 1);
  }
  return m;
}

template <int D>
Field<D> field_from(std::vector<float> values, const Index<D>& dims, const Affine<D>& transform) {
  const auto owner = std::make_shared<std::vector<float>>(std::move(values));
  return make_field<D>(owner->data(), dims, transform, owner);
}

template <int D>
std::vector<float> values_of(const Field<D>& field) {
  std::vector<float> values(field.voxels());
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = value_at(field.values, v);
  return values;
}

// Returns a field of h(x) at n^D points of the unit cube.
template <int D>
Field<D> sampled(int n, const std::function<double(const Vec<D>&)>& h) {
  std::size_t voxels = 1;
  Index<D> dims;
  for (int a = 0; a < D; ++a) dims[a] = n, voxels *= n;
  std::vector<float> values(voxels);
  for (std::size_t v = 0; v < voxels; ++v) {
    Vec<D> x;
    std::size_t rest = v;
    for (int a = 0; a < D; ++a, rest /= n) x[a] = static_cast<double>(rest % n) / (n - 1);
    values[v] = static_cast<float>(h(x));
  }
  return field_from<D>(std::move(values), dims, unit_cube<D>(n));
}

// Returns a field that is higher inside: isosurface c is the sphere (circle) of radius 1 - c about
// the center.
template <int D>
Field<D> ball(int n, const Vec<D>& center = Vec<D>(0.5)) {
  return sampled<D>(n, [&](const Vec<D>& x) { return 1 - (x - center).length(); });
}

inline Field<3> torus(int n) {
  return sampled<3>(n, [](const Vec3& x) {
    const Vec3 p = x - Vec3(0.5);
    const double ring = std::hypot(p.x, p.y) - 0.25;
    return 1 - std::hypot(ring, p.z);
  });
}

// Returns uniform noise that is `low` on the border, so that every isosurface above `low` is
// closed.
template <int D>
Field<D> noise(int n, std::uint64_t seed, double border) {
  Random random(seed);
  return sampled<D>(n, [&](const Vec<D>& x) {
    const double h = random.uniform();
    for (int a = 0; a < D; ++a) {
      if (x[a] == 0 || x[a] == 1) return border;
    }
    return h;
  });
}

inline Vec3 random_direction(Random& random) {
  const double z = 2 * random.uniform() - 1, phi = 6.283185307179586 * random.uniform();
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace leaflight::test
