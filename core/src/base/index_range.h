// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/vector.h"

namespace leaflight {

// Returns the number of a cell in a D-dimensional grid, with axis 0 fastest.
template <int D>
std::size_t linear_number(const Index<D>& index, const Index<D>& dims) {
  std::size_t number = index[D - 1];
  for (int a = D - 2; a >= 0; --a) number = number * dims[a] + index[a];
  return number;
}

template <int D>
Index<D> index_of(std::size_t number, const Index<D>& dims) {
  Index<D> index;
  for (int a = 0; a < D; ++a) {
    index[a] = static_cast<int>(number % dims[a]);
    number /= dims[a];
  }
  return index;
}

template <int D>
std::size_t cell_count(const Index<D>& dims) {
  std::size_t n = 1;
  for (int a = 0; a < D; ++a) n *= dims[a];
  return n;
}

// Calls visit(index) for each index with low <= index < high along every axis.
template <int D, class Visit>
void for_each_index(const Index<D>& low, const Index<D>& high, Visit visit) {
  for (int a = 0; a < D; ++a) {
    if (low[a] >= high[a]) return;
  }
  Index<D> i = low;
  for (;;) {
    visit(i);
    int a = 0;
    while (a < D && ++i[a] == high[a]) i[a] = low[a], ++a;
    if (a == D) return;
  }
}

}  // namespace leaflight
