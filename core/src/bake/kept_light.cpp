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

float share_of(int kept, int added) {
  return kept > 0 ? static_cast<float>(kept) / static_cast<float>(kept + added) : 0;
}

}  // namespace

float kept_share(const Average& found, int blocks, int kept) {
  return found.samples > 0 ? share_of(kept, blocks) : 1;
}

template <int D>
KeptLight<D>::KeptLight(RadianceGrid<D> grid, int rounds, int blocks)
    : grid_(std::move(grid)), rounds_(rounds), blocks_(blocks) {
  to_half(grid_.radiance_indirect);
  to_half(grid_.radiance_back_indirect);
  for (float& error : grid_.radiance_error) error = in_half(error);
}

template <int D>
void KeptLight<D>::add_to(std::vector<Average>& indirect, int blocks, bool inner) const {
  const float w = share_of(blocks_, blocks);
  for (std::size_t s = 0; s < indirect.size(); ++s) {
    Average& soft = indirect[s];
    soft.mean = soft.mean * (1 - w) + this->indirect(s, inner) * w;
    // A file keeps no error of the inner side: it is what as many blocks as were kept would err by,
    // as far as new ones tell.
    const float kept = inner ? soft.variance * blocks / std::max(1, blocks_)
                             : grid_.radiance_error[s] * grid_.radiance_error[s];
    soft.variance = soft.variance * (1 - w) * (1 - w) + kept * w * w;
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
