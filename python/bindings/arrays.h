// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/affine.h"
#include "base/bounds.h"
#include "base/error.h"
#include "field/texel_lattice.h"
#include "field/voxels.h"

namespace leaflight::python {

namespace py = pybind11;

using FloatArray = py::array_t<float, py::array::c_style>;
using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Returns a NumPy array of this shape that takes over the vector's memory, without a copy. `Scalar`
// is the type within the vector's elements.
template <class Scalar, class Element>
py::array_t<Scalar> adopt(std::vector<Element>&& data, std::vector<py::ssize_t> shape) {
  static_assert(sizeof(Element) % sizeof(Scalar) == 0);
  auto owner = std::make_unique<std::vector<Element>>(std::move(data));
  const auto* first = reinterpret_cast<const Scalar*>(owner->data());
  const py::capsule archive(owner.get(),
                            [](void* p) { delete static_cast<std::vector<Element>*>(p); });
  owner.release();
  return py::array_t<Scalar>(std::move(shape), first, archive);
}

// Returns an array of voxels with their type, without a copy.
inline py::array adopt(VoxelBuffer&& voxels, std::vector<py::ssize_t> shape) {
  return std::visit(
      [&](auto&& values) -> py::array {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        return adopt<Value>(std::move(values), std::move(shape));
      },
      std::move(voxels));
}

// NumPy's type of an array of voxels.
template <class Value>
using VoxelArray = py::array_t<Value, py::array::c_style>;

// Keeps an array alive as long as its voxels are used. Releasing it needs the interpreter's lock.
template <class Value>
std::shared_ptr<const void> kept(const VoxelArray<Value>& values) {
  return {new VoxelArray<Value>(values), [](const void* p) {
            const py::gil_scoped_acquire lock;
            delete static_cast<const VoxelArray<Value>*>(p);
          }};
}

// Returns a number of voxels along an axis.
inline int to_dim(py::ssize_t n) {
  if (n > std::numeric_limits<int>::max()) {
    throw Error("The volume is too large; crop or resample it.");
  }
  return static_cast<int>(n);
}

inline py::ssize_t rows(const py::array& array, py::ssize_t columns, const char* what) {
  if (array.ndim() != 2 || array.shape(1) != columns) {
    throw Error(std::string("The ") + what + " must be an array of shape (n, " +
                std::to_string(columns) + ").");
  }
  return array.shape(0);
}

// Converts a (D + 1) x (D + 1) matrix. Ignores its last row.
template <int D>
Affine<D> to_affine(const DoubleArray& matrix) {
  if (matrix.ndim() != 2 || matrix.shape(0) != D + 1 || matrix.shape(1) != D + 1) {
    const std::string n = std::to_string(D + 1);
    throw Error("The index-to-world transform must be a " + n + " x " + n + " matrix.");
  }
  Affine<D> m;
  for (int i = 0; i < D; ++i) {
    for (int a = 0; a < D; ++a) m.column[a][i] = matrix.at(i, a);
    m.origin[i] = matrix.at(i, D);
  }
  return m;
}

template <int D>
py::array_t<double> from_affine(const Affine<D>& m) {
  py::array_t<double> matrix({D + 1, D + 1});
  auto out = matrix.mutable_unchecked<2>();
  for (int i = 0; i <= D; ++i) {
    for (int a = 0; a <= D; ++a) {
      out(i, a) = i == D ? (a == D) : a == D ? m.origin[i] : m.column[a][i];
    }
  }
  return matrix;
}

// Throws an error for a point that is NaN or farther than 1e18 from the origin.
template <class Point>
void check_point(const Point& point) {
  if (!within_bounds(point)) {
    throw Error("A point is not a number or farther than 1e18 from the origin; leave it out.");
  }
}

template <int D>
std::vector<Vec<D>> to_points(const DoubleArray& array) {
  const py::ssize_t n = rows(array, D, "points");
  const auto view = array.unchecked<2>();
  std::vector<Vec<D>> points(n);
  for (py::ssize_t i = 0; i < n; ++i) {
    for (int a = 0; a < D; ++a) points[i][a] = view(i, a);
    check_point(points[i]);
  }
  return points;
}

// Type of an array of D numbers, a tuple in Python.
template <int D>
using Tuple = std::array<double, static_cast<std::size_t>(D)>;

template <int D>
Vec<D> to_vec(const Tuple<D>& v) {
  Vec<D> result;
  for (int a = 0; a < D; ++a) result[a] = v[a];
  return result;
}

inline Rgb to_color(const Tuple<3>& v) {
  return Rgb(static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2]));
}

inline std::vector<Rgb> to_colors(const std::vector<Tuple<3>>& all) {
  std::vector<Rgb> colors;
  for (const Tuple<3>& v : all) colors.push_back(to_color(v));
  return colors;
}

// Returns the shape of an array, last axis first: [z, y, x] or [y, x].
template <std::size_t D>
std::vector<py::ssize_t> array_shape(const std::array<int, D>& dims) {
  return {dims.rbegin(), dims.rend()};
}

// Returns a mask of active texels, uint8 [z, y, x] or [y, x].
template <int D>
py::array_t<std::uint8_t> active_mask(const TexelLattice<D>& lattice) {
  std::vector<std::uint8_t> active(lattice.texels(), 0);
  for (const std::uint32_t texel : lattice.active) active[texel] = 1;
  return adopt<std::uint8_t>(std::move(active), array_shape(lattice.resolution));
}

}  // namespace leaflight::python
