// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/kept_light.h"

#include <Imath/half.h>

#include <cmath>

#include "leaflight/bake/indirect_light.h"
#include "leaflight/transport/indirect_estimator.h"

namespace leaflight {
namespace {

float in_half(float x) { return static_cast<float>(half(x)); }

void to_half(std::vector<Vec<3, float>>& values) {
  for (auto& value : values) {
    for (int i = 0; i < 3; ++i) value[i] = in_half(value[i]);
  }
}

}  // namespace

template <int D>
KeptLight<D>::KeptLight(RadianceGrid<D> grid, int rounds, int blocks)
    : grid_(std::move(grid)), rounds_(rounds), blocks_(blocks) {
  to_half(grid_.radiance_indirect);
  to_half(grid_.radiance_back_indirect);
  for (float& error : grid_.radiance_error) error = in_half(error);
}

template <int D>
float KeptLight<D>::share(int blocks) const {
  return blocks_ > 0 ? static_cast<float>(blocks_) / static_cast<float>(blocks_ + blocks) : 0;
}

template <int D>
void KeptLight<D>::add_variance(std::vector<Average>& indirect, int blocks, bool inner) const {
  const float w = share(blocks), left = 1 - w;
  for (std::size_t s = 0; s < indirect.size(); ++s) {
    // A file keeps no error of the inner side: it is what as many blocks as were kept would err by,
    // as far as new ones tell.
    const float kept = inner ? indirect[s].variance / (left * left) * blocks / std::max(1, blocks_)
                             : grid_.radiance_error[s] * grid_.radiance_error[s];
    indirect[s].variance += kept * w * w;
  }
}

template <int D>
std::vector<Rgb> KeptLight<D>::soft(const Volume<D>& volume, const IsovalueWindow& window,
                                    bool inner, const TexelLattice<D>& to,
                                    Progress& progress) const {
  const TexelLattice<D>& lattice = grid_.lattice;
  std::vector<Average> white(lattice.active.size());
  for (std::size_t s = 0; s < white.size(); ++s) {
    const Vec<D> centre = lattice.centre(lattice.active[s]);
    const Rgb albedo = albedo_near(volume, centre);
    const Rgb reflected = indirect(s, inner) - emission_near(volume, window, centre);
    for (int i = 0; i < 3; ++i) {
      white[s].mean[i] = albedo[i] > 0 ? std::max(Real(0), reflected[i] / albedo[i]) : 0;
    }
  }
  std::vector<Rgb> result;
  for (const Average& average : interpolated(lattice, white, to, progress)) {
    result.push_back(average.mean);
  }
  return result;
}

template <int D>
Rgb KeptLight<D>::indirect(std::size_t slot, bool inner) const {
  return Rgb(inner ? grid_.radiance_back_indirect[slot] : grid_.radiance_indirect[slot]);
}

template <int D>
Rgb emission_near(const Volume<D>& volume, const IsovalueWindow& window,
                  const Vec<D>& index_position) {
  if (!(volume.emission.largest() > 0)) return Rgb(0);
  const CellPoint<D> at = locate(volume.field, index_position);
  const double h = interpolate(load_corners(volume.field, at.cell), at.local);
  const double c = std::isnan(h) ? window.min : volume.leaf_coordinate(h);
  return volume.emission.at(std::clamp(c, window.min, window.max));
}

template class KeptLight<2>;
template class KeptLight<3>;
template Rgb emission_near<2>(const Volume<2>&, const IsovalueWindow&, const Vec<2>&);
template Rgb emission_near<3>(const Volume<3>&, const IsovalueWindow&, const Vec<3>&);

}  // namespace leaflight
