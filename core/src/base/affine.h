// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/vector.h"

namespace leaflight {

// The map x -> sum_a x[a] * column[a] + origin.
template <int D>
struct Affine {
  std::array<Vec<D>, D> column;
  Vec<D> origin{0.0};

  Vec<D> vector(const Vec<D>& x) const {
    Vec<D> y(0.0);
    for (int a = 0; a < D; ++a) y += column[a] * x[a];
    return y;
  }
  Vec<D> point(const Vec<D>& x) const { return vector(x) + origin; }

  // Transforms a gradient. Gradients transform with the transposed matrix, in the opposite
  // direction.
  Vec<D> pull_back_gradient(const Vec<D>& g) const {
    Vec<D> y;
    for (int a = 0; a < D; ++a) y[a] = column[a].dot(g);
    return y;
  }
};

template <int D>
double determinant(const Affine<D>& m);

// Returns the inverse. Precondition: determinant(m) is finite and not zero.
template <int D>
Affine<D> inverse(const Affine<D>& m);

}  // namespace leaflight
