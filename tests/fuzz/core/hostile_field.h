// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "bytes.h"
#include "said.h"
#include "trace/isosurface_ray.h"

namespace leaflight::fuzz {

// A field of a few voxels along each axis, of any type, values and transform. Throws Error.
template <int D>
Field<D> hostile_field(Bytes& bytes) {
  const int type = bytes.choice(4);
  Index<D> dims;
  for (int& n : dims) n = bytes.choice(8);
  Affine<D> index_to_world;
  const bool placed = bytes.choice(2) != 0;
  for (int a = 0; a < D; ++a) {
    for (int i = 0; i < D; ++i) {
      index_to_world.column[a][i] = placed ? bytes.take<float>() : double(a == i);
    }
    if (placed) index_to_world.origin[a] = bytes.take<float>();
  }
  const auto of = [&](auto value) {
    using Value = decltype(value);
    const auto values = std::make_shared<std::vector<Value>>(cell_count<D>(dims));
    for (Value& h : *values) h = bytes.take<Value>();
    return make_field<D>(values->data(), dims, index_to_world, values);
  };
  if (type == 1) return of(std::uint8_t{});
  if (type == 2) return of(std::int16_t{});
  if (type == 3) return of(std::uint16_t{});
  return of(float{});
}

template <class Vector>
bool finite(const Vector& v) {
  bool all = true;
  for (unsigned a = 0; a < Vector::dimensions(); ++a) all = all && std::isfinite(v[a]);
  return all;
}

// True if all vertices of a contour are finite.
template <class Vertices>
bool all_finite(const Vertices& vertices) {
  bool all = true;
  for (const auto& v : vertices) all = all && finite(v);
  return all;
}

// A ray through the field from anywhere; what it hits lies in a cell, at a distance.
template <int D>
void shoot(const Field<D>& field, double isovalue, Bytes& bytes) {
  IsosurfaceRay<D> ray;
  for (int a = 0; a < D; ++a) {
    ray.position[a] = bytes.take<float>();
    ray.direction[a] = bytes.take<float>();
  }
  if (!finite(ray.position) || !finite(ray.direction) || !(ray.direction.length() > 0)) return;
  ray.isovalue = isovalue;
  const auto hit = intersect(field, ray);
  require(hit.has_value() == occluded(field, ray), "a ray that hits is not blocked");
  if (!hit) return;
  // 0 from within what rounding leaves of the isosurface, of values up to 1e38.
  require(hit->t >= 0 && std::isfinite(hit->t), "a hit at no distance");
  for (int a = 0; a < D; ++a) {
    const double x = hit->point.local[a];
    require(hit->point.cell[a] >= 0 && hit->point.cell[a] <= field.dims[a] - 2 && x >= 0 && x <= 1,
            "a hit outside its cell");
  }
}

}  // namespace leaflight::fuzz
