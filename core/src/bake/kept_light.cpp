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
KeptLight<D>::KeptLight(RadianceGrid<D> grid, int rounds, int direct_blocks, int indirect_blocks)
    : grid_(std::move(grid)),
      rounds_(rounds),
      direct_blocks_(direct_blocks),
      indirect_blocks_(indirect_blocks) {
  to_half(grid_.radiance);
  to_half(grid_.radiance_indirect);
  to_half(grid_.radiance_back);
  to_half(grid_.radiance_back_indirect);
  for (float& error : grid_.radiance_error) error = in_half(error);
}

template <int D>
void KeptLight<D>::add_to(std::vector<Average>& direct, int direct_blocks,
                          std::vector<Average>& indirect, int indirect_blocks, bool inner) const {
  const float w = share_of(direct_blocks_, direct_blocks);
  const float v = share_of(indirect_blocks_, indirect_blocks);
  for (std::size_t s = 0; s < direct.size(); ++s) {
    Average &own = direct[s], &soft = indirect[s];
    own.mean = own.mean * (1 - w) + this->direct(s, inner) * w;
    soft.mean = soft.mean * (1 - v) + this->indirect(s, inner) * v;
    // What as many blocks as were kept would err by, as far as new ones tell.
    const float own_kept = own.variance * direct_blocks / std::max(1, direct_blocks_);
    const float soft_kept = soft.variance * indirect_blocks / std::max(1, indirect_blocks_);
    const float both = own_kept + soft_kept, share = both > 0 ? own_kept / both : 1;
    const float kept = inner ? both : grid_.radiance_error[s] * grid_.radiance_error[s];
    own.variance = own.variance * (1 - w) * (1 - w) + kept * share * w * w;
    soft.variance = soft.variance * (1 - v) * (1 - v) + kept * (1 - share) * v * v;
  }
}

template <int D>
void KeptLight<D>::add_to_direct(std::vector<Average>& direct, int blocks, bool inner) const {
  for (std::size_t s = 0; s < direct.size(); ++s) {
    const float w = kept_share(direct[s], blocks, direct_blocks_);
    direct[s].mean = direct[s].mean * (1 - w) + this->direct(s, inner) * w;
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
Rgb KeptLight<D>::direct(std::size_t slot, bool inner) const {
  return Rgb(inner ? grid_.radiance_back[slot] : grid_.radiance[slot]) - indirect(slot, inner);
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
