// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/pooled_variance.h"

#include <algorithm>

#include "base/parallel.h"

namespace leaflight {
namespace {

// Calls visit(slot) for the texel and its active neighbors, in the same layer.
template <int D, class Visit>
void for_each_near(const TexelLattice<D>& lattice, std::size_t slot, Visit visit) {
  const Index<D> texel = lattice.texel(lattice.active[slot]);
  Index<D> low, high;
  for (int a = 0; a < D; ++a) {
    low[a] = std::max(texel[a] - 1, 0);
    high[a] = std::min(texel[a] + 2, lattice.resolution[a]);
  }
  for_each_index<D>(low, high, [&](const Index<D>& near) {
    const std::int32_t s = lattice.beside(slot, lattice.linear(near));
    if (s != TexelLattice<D>::inactive) visit(static_cast<std::size_t>(s));
  });
}

// Pools the variance of a texel with samples.
template <int D>
Average pooled(const TexelLattice<D>& lattice, const std::vector<Average>& averages,
               std::size_t slot) {
  double sum = 0, weight = 0;
  for_each_near<D>(lattice, slot, [&](std::size_t s) {
    // A single sample has no estimate of its variance.
    const double freedom = std::max(0.0f, averages[s].samples - 1);
    sum += freedom * averages[s].variance * averages[s].samples;
    weight += freedom;
  });
  Average result = averages[slot];
  result.variance = weight > 0 ? static_cast<float>(sum / (weight * result.samples)) : 0;
  return result;
}

// Returns the mean of the neighbors, for a texel without samples. If they have none either, that of
// its layers.
template <int D>
Average filled(const TexelLattice<D>& lattice, const std::vector<Average>& averages,
               std::size_t slot) {
  Imath::V3d sum(0);
  double weight = 0, square = 0;
  const auto add = [&](std::size_t s) {
    const double m = average(averages[s].mean);
    sum += Imath::V3d(averages[s].mean) * averages[s].samples;
    square += m * m * averages[s].samples;
    weight += averages[s].samples;
  };
  for_each_near<D>(lattice, slot, add);
  if (!(weight > 0) && lattice.has_layers()) {
    const std::int32_t first = lattice.layer_slot(lattice.active[slot], 0);
    for (int i = 0; i < lattice.layers && first != TexelLattice<D>::inactive; ++i) add(first + i);
  }
  if (!(weight > 0)) return {};
  const Imath::V3d mean = sum / weight;
  const double m = (mean.x + mean.y + mean.z) / 3;
  return {Rgb(mean), static_cast<float>(std::max(0.0, square / weight - m * m)), 0};
}

}  // namespace

template <int D>
void pool_variances(const TexelLattice<D>& lattice, std::vector<Average>& averages,
                    Progress& progress) {
  std::vector<Average> result(averages.size());
  parallel_each(averages.size(), 1024, progress, [&](std::size_t s) {
    const bool sampled = averages[s].samples > 0;
    result[s] = sampled ? pooled(lattice, averages, s) : filled(lattice, averages, s);
  });
  averages = std::move(result);
}

template <int D>
std::vector<Rgb> filled_means(const TexelLattice<D>& lattice, const std::vector<Average>& averages,
                              Progress& progress) {
  std::vector<Rgb> means(averages.size());
  parallel_each(averages.size(), 1024, progress, [&](std::size_t s) {
    const bool sampled = averages[s].samples > 0;
    means[s] = sampled ? averages[s].mean : filled(lattice, averages, s).mean;
  });
  return means;
}

template std::vector<Rgb> filled_means<2>(const TexelLattice<2>&, const std::vector<Average>&,
                                          Progress&);
template std::vector<Rgb> filled_means<3>(const TexelLattice<3>&, const std::vector<Average>&,
                                          Progress&);
template void pool_variances<2>(const TexelLattice<2>&, std::vector<Average>&, Progress&);
template void pool_variances<3>(const TexelLattice<3>&, std::vector<Average>&, Progress&);

}  // namespace leaflight
