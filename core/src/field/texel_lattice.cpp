// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/texel_lattice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/index_range.h"

namespace leaflight {
namespace {

// True if h crosses a value of [low, high] in the box of voxels [first, last). Tests row by row,
// because most boxes succeed early.
template <int D, class Value>
bool reached(const Field<D>& field, const Value* values, const Index<D>& first,
             const Index<D>& last, double low, double high) {
  float min = std::numeric_limits<float>::infinity(), max = -min;
  Index<D> row = first;
  for (;;) {
    const Value* const begin = values + field.offset(row);
    for (const Value* voxel = begin; voxel != begin + (last[0] - first[0]); ++voxel) {
      const float h = *voxel;
      // Comparisons with NaN are false, so masked voxels are skipped.
      if (h < min) min = h;
      if (h > max) max = h;
    }
    if (min < max && min < high && max >= low) return true;
    int a = 1;
    while (a < D && ++row[a] == last[a]) row[a] = first[a], ++a;
    if (a == D) return false;
  }
}

// True if h crosses such a value within one texel of a texel.
template <int D>
bool reached(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t number, double low,
             double high) {
  const Index<D> texel = lattice.texel(number);
  Index<D> first, last;
  for (int a = 0; a < D; ++a) {
    const double step = lattice.voxels_per_texel[a];
    first[a] = std::max(0, static_cast<int>(std::floor((texel[a] - 1) * step)));
    last[a] = std::min(field.dims[a], static_cast<int>(std::ceil((texel[a] + 1) * step)) + 1);
  }
  return std::visit(
      [&](const auto* values) { return reached<D>(field, values, first, last, low, high); },
      field.values);
}

template <int D>
std::string product(const Index<D>& resolution) {
  std::string text;
  for (const int n : resolution) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

}  // namespace

template <int D>
void TexelLattice<D>::activate(std::vector<std::uint32_t> numbers) {
  active = std::move(numbers);
  slot = RankedSet(texels(), active);
}

// Returns a lattice with texel positions, but without active texels.
template <int D>
TexelLattice<D> bare_lattice(const Index<D>& dims, const Index<D>& resolution) {
  TexelLattice<D> lattice;
  lattice.resolution = resolution;
  for (int a = 0; a < D; ++a) {
    lattice.voxels_per_texel[a] = static_cast<double>(dims[a] - 1) / (resolution[a] - 1);
  }
  return lattice;
}

template <int D>
TexelLattice<D> inactive_lattice(const Index<D>& dims, const Index<D>& resolution) {
  TexelLattice<D> lattice = bare_lattice<D>(dims, resolution);
  lattice.slot = RankedSet(cell_count<D>(resolution), std::vector<std::uint32_t>());
  return lattice;
}

template <int D>
void check_resolution(const Index<D>& resolution) {
  std::uint64_t texels = 1;
  for (int a = 0; a < D; ++a) {
    if (resolution[a] < 2 || resolution[a] > 65535) {
      throw Error("The resolution " + std::to_string(resolution[a]) +
                  " is not possible; choose between 2 and 65535 texels along each axis.");
    }
    texels *= static_cast<std::uint64_t>(resolution[a]);
  }
  if (texels > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error("A texture of " + product<D>(resolution) +
                " texels is too large; choose a lower resolution.");
  }
}

template <int D>
TexelLattice<D> make_lattice(const Field<D>& field, const Index<D>& resolution, double low,
                             double high) {
  check_resolution<D>(resolution);
  const std::size_t texels = cell_count<D>(resolution);
  TexelLattice<D> lattice = inactive_lattice<D>(field.dims, resolution);
  // Process pieces in the order of the texels.
  constexpr std::size_t piece = 4096;
  std::vector<std::vector<std::uint32_t>> pieces((texels + piece - 1) / piece);
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t p) {
    const std::size_t end = std::min<std::size_t>((p + 1) * piece, texels);
    for (std::size_t i = p * piece; i < end; ++i) {
      if (reached(field, lattice, i, low, high)) {
        pieces[p].push_back(static_cast<std::uint32_t>(i));
      }
    }
  });
  std::size_t count = 0;
  for (const std::vector<std::uint32_t>& numbers : pieces) count += numbers.size();
  std::vector<std::uint32_t> active;
  active.reserve(count);
  for (const std::vector<std::uint32_t>& numbers : pieces) {
    active.insert(active.end(), numbers.begin(), numbers.end());
  }
  lattice.activate(std::move(active));
  return lattice;
}

template <int D>
std::size_t active_texels(const Field<D>& field, const Index<D>& resolution, double low,
                          double high) {
  const TexelLattice<D> lattice = bare_lattice<D>(field.dims, resolution);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, cell_count<D>(resolution), 4096), std::size_t{0},
      [&](const auto& range, std::size_t count) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          count += reached(field, lattice, i, low, high);
        }
        return count;
      },
      std::plus<>());
}

template <int D>
CellPoint<D> TexelLattice<D>::cell_point(const Vec<D>& index_position) const {
  CellPoint<D> point;
  for (int a = 0; a < D; ++a) {
    const double x = std::clamp(index_position[a] / voxels_per_texel[a], 0.0,
                                static_cast<double>(resolution[a] - 1));
    point.cell[a] = std::min(static_cast<int>(x), resolution[a] - 2);
    point.local[a] = x - point.cell[a];
  }
  return point;
}

template <int D>
TexelWeights<D> linear_weights(const TexelLattice<D>& lattice, const Vec<D>& index_position) {
  const auto [base, local] = lattice.cell_point(index_position);
  TexelWeights<D> result;
  std::array<double, 1 << D> weights;
  double sum = 0;
  const auto add = [&](double weight, std::int32_t slot) {
    if (slot == TexelLattice<D>::inactive) return;
    result.slot[result.count] = slot;
    weights[result.count++] = weight;
    sum += weight;
  };
  // Visit pairs of adjacent texels along axis 0.
  for (int others = 0; others < (1 << (D - 1)); ++others) {
    Index<D> texel = base;
    double low = 1 - local[0], high = local[0];
    for (int a = 1; a < D; ++a) {
      const int bit = (others >> (a - 1)) & 1;
      texel[a] += bit;
      low *= bit ? local[a] : 1 - local[a];
      high *= bit ? local[a] : 1 - local[a];
    }
    const std::size_t number = lattice.linear(texel);
    if (low > 0 && high > 0) {
      const auto slots = lattice.slot.two_from(number);
      add(low, slots[0]);
      add(high, slots[1]);
    } else if (low > 0) {
      add(low, lattice.slot[number]);
    } else if (high > 0) {
      add(high, lattice.slot[number + 1]);
    }
  }
  // Normalize the weights over the active texels.
  for (int i = 0; i < result.count; ++i) {
    result.weight[i] = static_cast<float>(sum == 1 ? weights[i] : weights[i] / sum);
  }
  return result;
}

template <int D>
std::int32_t nearest_active_slot(const TexelLattice<D>& lattice, const Vec<D>& index_position) {
  constexpr int reach = 3;
  const Vec<D> position = index_position / lattice.voxels_per_texel;
  const Index<D> nearest = lattice.nearest_texel(position);
  std::int32_t found = lattice.slot[lattice.linear(nearest)];
  if (found != TexelLattice<D>::inactive) return found;
  Index<D> low, high;
  for (int a = 0; a < D; ++a) {
    low[a] = std::max(0, nearest[a] - reach);
    high[a] = std::min(lattice.resolution[a], nearest[a] + reach + 1);
  }
  double least = std::numeric_limits<double>::infinity();
  for_each_index<D>(low, high, [&](const Index<D>& texel) {
    const std::int32_t slot = lattice.slot[lattice.linear(texel)];
    const double distance2 = (to_vector<D>(texel) - position).length2();
    if (slot == TexelLattice<D>::inactive || distance2 >= least) return;
    least = distance2;
    found = slot;
  });
  return found;
}

template struct TexelLattice<2>;
template struct TexelLattice<3>;
template TexelLattice<2> inactive_lattice<2>(const Index<2>&, const Index<2>&);
template TexelLattice<3> inactive_lattice<3>(const Index<3>&, const Index<3>&);
template void check_resolution<2>(const Index<2>&);
template void check_resolution<3>(const Index<3>&);
template TexelLattice<2> make_lattice<2>(const Field<2>&, const Index<2>&, double, double);
template TexelLattice<3> make_lattice<3>(const Field<3>&, const Index<3>&, double, double);
template std::size_t active_texels<2>(const Field<2>&, const Index<2>&, double, double);
template std::size_t active_texels<3>(const Field<3>&, const Index<3>&, double, double);
template std::int32_t nearest_active_slot<2>(const TexelLattice<2>&, const Vec<2>&);
template std::int32_t nearest_active_slot<3>(const TexelLattice<3>&, const Vec<3>&);
template TexelWeights<2> linear_weights<2>(const TexelLattice<2>&, const Vec<2>&);
template TexelWeights<3> linear_weights<3>(const TexelLattice<3>&, const Vec<3>&);

}  // namespace leaflight
