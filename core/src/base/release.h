// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace leaflight {

// Empties a vector and frees its memory. (`vector = {}` assigns an empty list, which keeps the
// memory.)
template <class Element>
void release(std::vector<Element>& vector) {
  std::vector<Element>().swap(vector);
}

}  // namespace leaflight
