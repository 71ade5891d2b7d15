// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/texel_lattice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/index_range.h"

namespace leaflight {
namespace {

// Finds the active texels of rows along axis 0.
template <int D, class Value>
class ReachedTexels {
 public:
  ReachedTexels(const Field<D>& field, const Value* values, const TexelLattice<D>& lattice,
                double low, double high)
      : dims_(field.dims), values_(values), lattice_(lattice), low_(low), high_(high) {}

  // Calls visit(number) for the active texels of rows [begin, end), ascending.
  template <class Visit>
  void operator()(std::size_t begin, std::size_t end, Visit visit) const {
    std::vector<Value> min(dims_[0]), max(dims_[0]);
    const int texels = lattice_.resolution[0];
    for (std::size_t row = begin; row < end; ++row) {
      bound_columns(lattice_.texel(row * texels), min, max);
      for (int x = 0; x < texels; ++x) {
        const auto [first, last] = voxels_near(0, x);
        if (is_crossed(&min[first], &max[first], last - first)) visit(row * texels + x);
      }
    }
  }

 private:
  // Returns the voxels [first, last) within one texel of a texel, along an axis.
  std::array<int, 2> voxels_near(int axis, int texel) const {
    const double step = lattice_.voxels_per_texel[axis];
    return {std::max(0, static_cast<int>(std::floor((texel - 1) * step))),
            std::min(dims_[axis], static_cast<int>(std::ceil((texel + 1) * step)) + 1)};
  }
  // Bounds the values with the same x of the voxels near a row of texels.
  void bound_columns(const Index<D>& texel, std::vector<Value>& min,
                     std::vector<Value>& max) const {
    using Limits = std::numeric_limits<Value>;
    std::fill(min.begin(), min.end(), Limits::has_infinity ? Limits::infinity() : Limits::max());
    std::fill(max.begin(), max.end(),
              Limits::has_infinity ? -Limits::infinity() : Limits::lowest());
    Index<D> first{}, last;
    last[0] = 1;
    for (int a = 1; a < D; ++a) {
      const auto [begin, end] = voxels_near(a, texel[a]);
      first[a] = begin, last[a] = end;
    }
    for_each_index<D>(first, last, [&](const Index<D>& row) {
      const Value* const h = values_ + linear_number<D>(row, dims_);
      // Comparisons with NaN are false, so masked voxels are skipped.
      for (int x = 0; x < dims_[0]; ++x) {
        min[x] = h[x] < min[x] ? h[x] : min[x];
        max[x] = h[x] > max[x] ? h[x] : max[x];
      }
    });
  }
  // True if h crosses a value of [low, high] between these bounds of some columns.
  bool is_crossed(const Value* min, const Value* max, int columns) const {
    const Value least = *std::min_element(min, min + columns);
    const Value greatest = *std::max_element(max, max + columns);
    return least < greatest && least < high_ && greatest >= low_;
  }

  const Index<D>& dims_;
  const Value* values_;
  const TexelLattice<D>& lattice_;
  double low_, high_;
};

// Calls body(find), where find(begin, end, visit) finds the active texels of rows.
template <int D, class Body>
void with_reached_texels(const Field<D>& field, const TexelLattice<D>& lattice, double low,
                         double high, Body body) {
  std::visit([&](const auto* values) { body(ReachedTexels(field, values, lattice, low, high)); },
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
  active_texels = active.size();
  slot = RankedSet(texels(), active);
}

template <int D>
void TexelLattice<D>::add_layers(const std::vector<std::uint32_t>& numbers, double low,
                                 double high) {
  if (numbers.empty()) return;
  capped = RankedSet(texels(), numbers);
  lowest_layer = low;
  layer_step = (high - low) / layers;
  active.reserve(active_texels + numbers.size() * layers);
  for (const std::uint32_t number : numbers) active.insert(active.end(), layers, number);
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
  const std::size_t rows = texels / resolution[0], piece = 1 + 4096 / resolution[0];
  std::vector<std::vector<std::uint32_t>> pieces((rows + piece - 1) / piece);
  with_reached_texels(field, lattice, low, high, [&](const auto& find) {
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t p) {
      find(p * piece, std::min<std::size_t>((p + 1) * piece, rows),
           [&](std::size_t number) { pieces[p].push_back(static_cast<std::uint32_t>(number)); });
    });
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
  const std::size_t rows = cell_count<D>(resolution) / resolution[0];
  std::atomic<std::size_t> count{0};
  with_reached_texels(field, lattice, low, high, [&](const auto& find) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const auto& range) {
      std::size_t found = 0;
      find(range.begin(), range.end(), [&](std::size_t) { ++found; });
      count += found;
    });
  });
  return count;
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
