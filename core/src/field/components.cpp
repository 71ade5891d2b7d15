// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/components.h"

#include <algorithm>
#include <limits>

#include "base/disjoint_sets.h"
#include "base/error.h"

namespace leaflight {
namespace {

using Number = std::uint32_t;

// Joins each voxel of a slice with its neighbors before it.
template <class Value>
void join_slice(const Value* values, float isovalue, const Index<3>& dims, int k,
                DisjointSets<Number>& sets) {
  const auto row = static_cast<Number>(dims[0]), slice = row * static_cast<Number>(dims[1]);
  for (int j = 0; j < dims[1]; ++j) {
    Number v = static_cast<Number>(k) * slice + static_cast<Number>(j) * row;
    for (int i = 0; i < dims[0]; ++i, ++v) {
      if (!(values[v] >= isovalue)) continue;
      if (i > 0 && values[v - 1] >= isovalue) sets.join(v - 1, v);
      if (j > 0 && values[v - row] >= isovalue) sets.join(v - row, v);
      if (k > 0 && values[v - slice] >= isovalue) sets.join(v - slice, v);
    }
  }
}

// Replaces the names of sets by numbers in descending order of size, and equal sizes in the order
// of the voxels. Names of voxels below the isovalue become 0.
template <class Value>
Components numbered(std::vector<Number> names, const Value* values, float isovalue) {
  std::vector<Number> size(names.size()), parts;
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (!(values[v] >= isovalue)) continue;
    if (names[v] == v) parts.push_back(names[v]);
    ++size[names[v]];
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [&](Number a, Number b) { return size[a] > size[b]; });
  Components found;
  found.sizes.push_back(0);
  for (const Number part : parts) found.sizes.push_back(size[part]);
  for (std::size_t n = 0; n < parts.size(); ++n) size[parts[n]] = static_cast<Number>(n + 1);
  for (std::size_t v = 0; v < names.size(); ++v) {
    names[v] = values[v] >= isovalue ? size[names[v]] : 0;
  }
  found.of_voxel = std::move(names);
  return found;
}

}  // namespace

Components components(const Field<3>& field, float isovalue, Progress& progress) {
  const std::size_t count = field.voxels();
  if (count > std::numeric_limits<Number>::max()) {
    throw Error("The volume has too many voxels for its connected parts: downsample it.");
  }
  progress.begin("Connecting parts");
  progress.expect(field.dims[2]);
  return std::visit(
      [&](const auto* values) {
        DisjointSets<Number> sets(count);
        for (int k = 0; k < field.dims[2]; ++k) {
          progress.check();
          join_slice(values, isovalue, field.dims, k, sets);
          progress.advance(1);
        }
        return numbered(sets.names(), values, isovalue);
      },
      field.values);
}

}  // namespace leaflight
