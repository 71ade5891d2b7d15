// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "leaflight/math/affine.h"
#include "leaflight/math/error.h"

namespace leaflight::python {

namespace py = pybind11;

using FloatArray = py::array_t<float, py::array::c_style>;
using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

// The vector becomes the memory of a NumPy array of the given shape; nothing is copied. `Scalar` is
// what the vector's elements are made of.
template <class Scalar, class Element>
py::array_t<Scalar> adopt(std::vector<Element>&& data, std::vector<py::ssize_t> shape) {
  static_assert(sizeof(Element) % sizeof(Scalar) == 0);
  auto owner = std::make_unique<std::vector<Element>>(std::move(data));
  const auto* first = reinterpret_cast<const Scalar*>(owner->data());
  const py::capsule keeper(owner.get(),
                           [](void* p) { delete static_cast<std::vector<Element>*>(p); });
  owner.release();
  return py::array_t<Scalar>(std::move(shape), first, keeper);
}

inline py::ssize_t rows(const DoubleArray& array, py::ssize_t columns, const char* what) {
  if (array.ndim() != 2 || array.shape(1) != columns) {
    throw Error(std::string("The ") + what + " must be an array of shape (n, " +
                std::to_string(columns) + ").");
  }
  return array.shape(0);
}

inline Affine<3> to_affine(const DoubleArray& matrix) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) {
    throw Error("The index-to-world transform must be a 4 x 4 matrix.");
  }
  Affine<3> m;
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) m.column[a][i] = matrix.at(i, a);
    m.origin[i] = matrix.at(i, 3);
  }
  return m;
}

inline py::array_t<double> from_affine(const Affine<3>& m) {
  py::array_t<double> matrix({4, 4});
  auto out = matrix.mutable_unchecked<2>();
  for (int i = 0; i < 4; ++i) {
    for (int a = 0; a < 4; ++a) {
      out(i, a) = i == 3 ? (a == 3) : a == 3 ? m.origin[i] : m.column[a][i];
    }
  }
  return matrix;
}

inline std::vector<Vec3> to_points(const DoubleArray& array) {
  const py::ssize_t n = rows(array, 3, "points");
  const auto view = array.unchecked<2>();
  std::vector<Vec3> points;
  points.reserve(n);
  for (py::ssize_t i = 0; i < n; ++i) points.emplace_back(view(i, 0), view(i, 1), view(i, 2));
  return points;
}

template <class T>
T to_triple(const std::array<double, 3>& v) {
  return T(static_cast<typename T::BaseType>(v[0]), static_cast<typename T::BaseType>(v[1]),
           static_cast<typename T::BaseType>(v[2]));
}

template <class T>
std::array<double, 3> from_triple(const T& v) {
  return {v[0], v[1], v[2]};
}

inline std::vector<py::ssize_t> shape_zyx(const Index<3>& dims) {
  return {dims[2], dims[1], dims[0]};
}

}  // namespace leaflight::python
