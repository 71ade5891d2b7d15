// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/radiance_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "field/cap_layers.h"
#include "field/shading_gradient.h"

namespace leaflight {

namespace {

using Colors = std::vector<Vec<3, float>>;

}  // namespace

template <int D>
Vec<3, float> derived_radiance(const RadianceGrid<D>& grid, const Field<D>& field, std::size_t slot,
                               bool back) {
  const Colors& indirect = back ? grid.radiance_back_indirect : grid.radiance_indirect;
  const Vec<D> center = grid.lattice.center(grid.lattice.active[slot]);
  return Vec<3, float>(grid.direct->radiance(field, center, back) + Rgb(indirect[slot]));
}

template <int D>
Vec<3, float> radiance_of_texel(const RadianceGrid<D>& grid, const Field<D>& field,
                                std::size_t slot, bool back) {
  const Colors& stored = back ? grid.radiance_back : grid.radiance;
  return stored.empty() ? derived_radiance(grid, field, slot, back) : stored[slot];
}

template <int D>
std::vector<Vec<3, float>> all_light(const RadianceGrid<D>& grid, const Field<D>& field,
                                     bool back) {
  const Colors& stored = back ? grid.radiance_back : grid.radiance;
  if (stored.size() == grid.texels()) return stored;
  Colors light(grid.texels());
  parallel_each(light.size(),
                [&](std::size_t s) { light[s] = radiance_of_texel(grid, field, s, back); });
  return light;
}

namespace {

template <int D>
void prefetch(const TexelWeights<D>& near, const Colors& values) {
  for (int i = 0; i < near.count; ++i) __builtin_prefetch(&values[near.slot[i]]);
}

}  // namespace

template <int D>
void check_light(const ShownGrid<D>& shown, bool back) {
  if (back && !shown.grid.has_back()) {
    throw Error("This bake does not hold the back of its isosurfaces; bake both sides.");
  }
  if (!shown.has_light(back)) {
    throw Error("The direct light of this bake is missing; load the bake again.");
  }
}

template <int D>
Vec<3, float> lookup(const Field<D>& field, const TexelLattice<D>& lattice,
                     const std::vector<Vec<3, float>>& values, const Vec<D>& index_position) {
  return mean(surface_weights(field, lattice, index_position), values);
}

namespace {

// Compares the isosurfaces at a point with those ahead of it, by their gradients in index
// coordinates. Returns 1 if both are parallel and equally dense, 0 if the field turns or ends.
template <int D>
float likeness(const Vec<D>& here, const Vec<D>& ahead) {
  const double square = std::max(here.dot(here), ahead.dot(ahead));
  const double like = square > 0 ? std::max(0.0, here.dot(ahead) / square) : 0;
  return static_cast<float>(like * like * (3 - 2 * like));
}

// The texels that one lookup reads. Texels behind an isosurface may belong to the other face of a
// thin shell. Therefore part of the indirect light is extrapolated from 0.5 and 1.5 texels in front
// of the point. The part is likeness() of the isosurfaces 1.5 texels ahead. Texels around the point
// give the rest (docs/decisions/light-of-steep-data.md). They give all light if texels
// hold the direct light, too.
template <int D>
class PointLookup {
 public:
  void find(const ShownGrid<D>& shown, const Field<D>& field, const Vec<D>& index_position,
            bool back) {
    const TexelLattice<D>& lattice = shown.grid.lattice;
    position_ = index_position;
    in_front_ = 0;
    direct_ = shown.direct_of(back);
    if (direct_) {
      point_ = isosurface_point(field, index_position);
      maps_ = linear_weights(direct_->lattice(), index_position);
      look_ahead(lattice, field, back);
    }
    around_ = surface_weights(field, lattice, index_position);
  }
  void fetch(const Colors& values, bool back) const {
    prefetch(around_, values);
    if (in_front_ > 0) {
      prefetch(near_, values);
      prefetch(far_, values);
    }
    if (direct_) direct_->prefetch(maps_, back);
  }
  Vec<3, float> radiance(const ShownGrid<D>& shown, const Field<D>& field, const Colors& values,
                         bool back) const {
    Vec<3, float> light = of_texels(values);
    if (direct_) {
      light = shown.scaled(light, field, point_.position) +
              Vec<3, float>(direct_->radiance(point_, maps_, back));
    }
    return shown.textured(light, position_);
  }

 private:
  // Upper bound on the ratio of extrapolated light to unextrapolated light.
  static constexpr float most = 2;
  // Smaller shares in front are ignored.
  static constexpr float least_share = 0.02f;

  void look_ahead(const TexelLattice<D>& lattice, const Field<D>& field, bool back) {
    const Vec<D>& gradient = point_.gradient;
    const double length = (gradient / lattice.voxels_per_texel).length();
    if (!(length > 0)) return;
    const Vec<D> half = gradient * ((back ? 0.5 : -0.5) / length);
    const Vec<D> near = point_.position + half, far = near + half * 2;
    const IsovalueRange& isovalue_range = direct_->isovalue_range();
    if (!isovalue_range.contains(value_at(field, near)) ||
        !isovalue_range.contains(value_at(field, far))) {
      return;
    }
    const float like = likeness<D>(gradient, shading_gradient(field, locate(field, far)));
    if (like < least_share) return;
    in_front_ = like;
    near_ = linear_weights(lattice, near);
    far_ = linear_weights(lattice, far);
  }
  Vec<3, float> of_texels(const Colors& values) const {
    const Vec<3, float> around = mean(around_, values);
    if (!(in_front_ > 0)) return around;
    return around * (1 - in_front_) + extrapolated(values) * in_front_;
  }
  Vec<3, float> extrapolated(const Colors& values) const {
    const Vec<3, float> near = mean(near_, values), far = mean(far_, values);
    Vec<3, float> light;
    for (int i = 0; i < 3; ++i) {
      light[i] = std::clamp(near[i] + 0.5f * (near[i] - far[i]), near[i] / most, near[i] * most);
    }
    return light;
  }

  const DirectLight<D>* direct_ = nullptr;
  Vec<D> position_;
  IsosurfacePoint<D> point_;
  TexelWeights<D> around_, near_, far_;
  TexelWeights<D> maps_;  // in the lattice of the maps
  float in_front_ = 0;    // share of the light that is extrapolated, 0..1
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
float lookup_error(const Field<D>& field, const TexelLattice<D>& lattice,
                   const std::vector<float>& errors, const Vec<D>& index_position) {
  const TexelWeights<D> weights = surface_weights(field, lattice, index_position);
  float variance = 0;
  for (int i = 0; i < weights.count; ++i) {
    const float error = errors[weights.slot[i]] * weights.weight[i];
    variance += error * error;
  }
  return std::sqrt(variance);
}

template Vec<3, float> derived_radiance(const RadianceGrid<2>&, const Field<2>&, std::size_t, bool);
template Vec<3, float> derived_radiance(const RadianceGrid<3>&, const Field<3>&, std::size_t, bool);
template Vec<3, float> radiance_of_texel(const RadianceGrid<2>&, const Field<2>&, std::size_t,
                                         bool);
template Vec<3, float> radiance_of_texel(const RadianceGrid<3>&, const Field<3>&, std::size_t,
                                         bool);
template std::vector<Vec<3, float>> all_light(const RadianceGrid<2>&, const Field<2>&, bool);
template std::vector<Vec<3, float>> all_light(const RadianceGrid<3>&, const Field<3>&, bool);
template void check_light<2>(const ShownGrid<2>&, bool);
template void check_light<3>(const ShownGrid<3>&, bool);
template Vec<3, float> lookup<2>(const Field<2>&, const TexelLattice<2>&,
                                 const std::vector<Vec<3, float>>&, const Vec<2>&);
template Vec<3, float> lookup<3>(const Field<3>&, const TexelLattice<3>&,
                                 const std::vector<Vec<3, float>>&, const Vec<3>&);
template struct ShownGrid<2>;
template struct ShownGrid<3>;
template Vec<3, float> radiance_at<2>(const ShownGrid<2>&, const Field<2>&, const Vec<2>&, bool);
template Vec<3, float> radiance_at<3>(const ShownGrid<3>&, const Field<3>&, const Vec<3>&, bool);
template void radiance_at<2>(const ShownGrid<2>&, const Field<2>&, const std::vector<Vec<2>>&, bool,
                             Vec<3, float>*);
template void radiance_at<3>(const ShownGrid<3>&, const Field<3>&, const std::vector<Vec<3>>&, bool,
                             Vec<3, float>*);
template float lookup_error<2>(const Field<2>&, const TexelLattice<2>&, const std::vector<float>&,
                               const Vec<2>&);
template float lookup_error<3>(const Field<3>&, const TexelLattice<3>&, const std::vector<float>&,
                               const Vec<3>&);

}  // namespace leaflight
