// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/radiance_grid.h"

#include <algorithm>
#include <cmath>

#include "base/release.h"

namespace leaflight {

namespace {

using Colors = std::vector<Vec<3, float>>;

Colors sums(const std::vector<Average>& direct, const std::vector<Average>& indirect) {
  Colors sums;
  sums.reserve(direct.size());
  for (std::size_t s = 0; s < direct.size(); ++s) {
    sums.emplace_back(direct[s].mean + indirect[s].mean);
  }
  return sums;
}

Colors means(const std::vector<Average>& averages) {
  Colors means;
  means.reserve(averages.size());
  for (const Average& average : averages) means.emplace_back(average.mean);
  return means;
}

}  // namespace

template <int D>
RadianceGrid<D> make_grid(SideAverages direct, SideAverages indirect) {
  RadianceGrid<D> grid;
  grid.radiance = sums(direct[0], indirect[0]);
  grid.radiance_back = sums(direct[1], indirect[1]);
  grid.radiance_error.reserve(direct[0].size());
  for (std::size_t s = 0; s < direct[0].size(); ++s) {
    grid.radiance_error.push_back(std::sqrt(direct[0][s].variance + indirect[0][s].variance));
  }
  // Free the averages, which take most of the memory of a large bake here.
  direct = {};
  grid.radiance_indirect = means(indirect[0]);
  release(indirect[0]);
  grid.radiance_back_indirect = means(indirect[1]);
  return grid;
}

namespace {

template <int D>
void prefetch(const TexelWeights<D>& near, const Colors& values) {
  for (int i = 0; i < near.count; ++i) __builtin_prefetch(&values[near.slot[i]]);
}

template <int D>
Vec<3, float> mean(const TexelWeights<D>& near, const Colors& values) {
  Vec<3, float> mean(0);
  for (int i = 0; i < near.count; ++i) mean += values[near.slot[i]] * near.weight[i];
  return mean;
}

}  // namespace

template <int D>
Vec<3, float> lookup(const TexelLattice<D>& lattice, const std::vector<Vec<3, float>>& values,
                     const Vec<D>& index_position) {
  return mean(linear_weights(lattice, index_position), values);
}

namespace {

// The texels that one lookup reads.
template <int D>
class PointLookup {
 public:
  void find(const ShownGrid<D>& shown, const Field<D>& field, const Vec<D>& index_position,
            bool back) {
    direct_ = shown.direct_of(back);
    if (direct_) {
      point_ = isosurface_point(field, index_position);
      maps_ = linear_weights(direct_->lattice(), index_position);
    }
    near_ = linear_weights(shown.grid.lattice, index_position);
  }
  void fetch(const Colors& values, bool back) const {
    prefetch(near_, values);
    if (direct_) direct_->prefetch(maps_, back);
  }
  Vec<3, float> radiance(const ShownGrid<D>& shown, const Field<D>& field, const Colors& values,
                         bool back) const {
    const Vec<3, float> light = mean(near_, values);
    if (!direct_) return light;
    return shown.scaled(light, field, point_.position) +
           Vec<3, float>(direct_->radiance(point_, maps_, back));
  }

 private:
  const DirectLight<D>* direct_ = nullptr;
  IsosurfacePoint<D> point_;
  TexelWeights<D> near_, maps_;  // in the lattice of the grid, and in that of the maps
};

// Returns the texels for lookups.
template <int D>
const Colors& texels_of(const ShownGrid<D>& shown, bool back) {
  const RadianceGrid<D>& grid = shown.grid;
  if (shown.direct_of(back)) return back ? grid.radiance_back_indirect : grid.radiance_indirect;
  return back ? grid.radiance_back : grid.radiance;
}

}  // namespace

template <int D>
Vec<3, float> ShownGrid<D>::scaled(const Vec<3, float>& light, const Field<D>& field,
                                   const Vec<D>& index_position) const {
  if (indirect == Vec<3, float>(1)) return light;
  const Vec<3, float> own(direct->emission(field, index_position));
  Vec<3, float> scaled = own + (light - own) * indirect;
  for (int i = 0; i < 3; ++i) scaled[i] = std::max(0.0f, scaled[i]);
  return scaled;
}

template <int D>
Vec<3, float> radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                          const Vec<D>& index_position, bool back) {
  PointLookup<D> lookup;
  lookup.find(shown, field, index_position, back);
  return lookup.radiance(shown, field, texels_of(shown, back), back);
}

template <int D>
void radiance_at(const ShownGrid<D>& shown, const Field<D>& field,
                 const std::vector<Vec<D>>& index_positions, bool back, Vec<3, float>* found) {
  constexpr std::size_t ahead = 16;
  const Colors& values = texels_of(shown, back);
  std::array<PointLookup<D>, ahead> lookups;
  for (std::size_t first = 0; first < index_positions.size(); first += ahead) {
    const std::size_t count = std::min(ahead, index_positions.size() - first);
    for (std::size_t n = 0; n < count; ++n) {
      lookups[n].find(shown, field, index_positions[first + n], back);
      lookups[n].fetch(values, back);
    }
    for (std::size_t n = 0; n < count; ++n) {
      found[first + n] = lookups[n].radiance(shown, field, values, back);
    }
  }
}

template <int D>
float lookup_error(const TexelLattice<D>& lattice, const std::vector<float>& errors,
                   const Vec<D>& index_position) {
  const TexelWeights<D> weights = linear_weights(lattice, index_position);
  float variance = 0;
  for (int i = 0; i < weights.count; ++i) {
    const float error = errors[weights.slot[i]] * weights.weight[i];
    variance += error * error;
  }
  return std::sqrt(variance);
}

template RadianceGrid<2> make_grid<2>(SideAverages, SideAverages);
template RadianceGrid<3> make_grid<3>(SideAverages, SideAverages);
template Vec<3, float> lookup<2>(const TexelLattice<2>&, const std::vector<Vec<3, float>>&,
                                 const Vec<2>&);
template Vec<3, float> lookup<3>(const TexelLattice<3>&, const std::vector<Vec<3, float>>&,
                                 const Vec<3>&);
template struct ShownGrid<2>;
template struct ShownGrid<3>;
template Vec<3, float> radiance_at<2>(const ShownGrid<2>&, const Field<2>&, const Vec<2>&, bool);
template Vec<3, float> radiance_at<3>(const ShownGrid<3>&, const Field<3>&, const Vec<3>&, bool);
template void radiance_at<2>(const ShownGrid<2>&, const Field<2>&, const std::vector<Vec<2>>&, bool,
                             Vec<3, float>*);
template void radiance_at<3>(const ShownGrid<3>&, const Field<3>&, const std::vector<Vec<3>>&, bool,
                             Vec<3, float>*);
template float lookup_error<2>(const TexelLattice<2>&, const std::vector<float>&, const Vec<2>&);
template float lookup_error<3>(const TexelLattice<3>&, const std::vector<float>&, const Vec<3>&);

}  // namespace leaflight
