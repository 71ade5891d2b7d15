// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/texel_light.h"

#include <cmath>
#include <limits>

#include "bake/texels/area_points.h"
#include "bake/texels/pooled_variance.h"
#include "base/parallel.h"
#include "field/cap_layers.h"
#include "transport/indirect_estimator.h"

namespace leaflight {
namespace {

template <int D>
Rgb texel_emission(const Volume<D>& volume, const IsovalueRange& isovalue_range,
                   const TexelLattice<D>& lattice, std::size_t slot) {
  if (!(volume.emission.largest() > 0)) return Rgb(0);
  const double h = slot_value(volume.field, lattice, slot);
  const double c = std::isnan(h) ? isovalue_range.min : volume.common_isovalue(h);
  return volume.emission.at(std::clamp(c, isovalue_range.min, isovalue_range.max));
}

// Returns NaN for texels without samples.
std::vector<Vec<3, float>> known_means(const std::vector<Average>& averages) {
  std::vector<Vec<3, float>> means(averages.size());
  parallel_each(means.size(), [&](std::size_t s) {
    const Vec<3, float> unknown(std::numeric_limits<float>::quiet_NaN());
    means[s] = averages[s].samples > 0 ? Vec<3, float>(averages[s].mean) : unknown;
  });
  return means;
}

}  // namespace

template <int D>
TexelLight<D>::TexelLight(LitScene<D>& scene, std::size_t volume, BakeTexels<D>& texels,
                          const PreviousLight<D>* previous, int first_block)
    : scene_(scene),
      volume_(scene.volumes[volume]),
      direct_(scene.direct[volume]),
      previous_(previous),
      texels_(std::move(texels.shown)),
      errors_(volume_.tracer.scene().isovalue_range) {
  if (!scene_.plan.indirect) return;
  indirect_ =
      std::make_unique<IndirectLight<D>>(volume_, std::move(texels.indirect), texels.spacing,
                                         scene_.plan.back, scene_.settings.seed, first_block);
}

template <int D>
std::vector<Average> TexelLight<D>::averages(bool back) const {
  NoisyLight light{indirect_->averages(back), {}};
  if (previous_) previous_->blend(light, indirect_->blocks(), back);
  return std::move(light.averages);
}

template <int D>
const std::vector<TexelSurface<D>>& TexelLight<D>::surfaces() {
  if (surfaces_.empty()) surfaces_ = texel_surfaces(volume_, lattice(), scene_.progress);
  return surfaces_;
}

template <int D>
void TexelLight<D>::serialize(Archive& archive) {
  if (indirect_) indirect_->serialize(archive);
}

template <int D>
RadianceGrid<D> TexelLight<D>::grid() {
  scene_.progress.begin("Lighting texels");
  RadianceGrid<D> result;
  const std::array<NoisyLight, 2> light = filtered_light(result.unfiltered);
  result.lattice = texels_.lattice;
  result.direct = direct_;
  result.texture = volume_.volume().texture;
  const std::size_t count = result.texels();
  result.radiance_error.resize(count);
  for (const bool back : {false, true}) {
    if (back && !scene_.plan.back) continue;
    auto& means = back ? result.radiance_back_indirect : result.radiance_indirect;
    means.resize(count);
    parallel_each(count, 1024, scene_.progress, [&](std::size_t s) {
      const Average found = finished(light[back].averages, s);
      means[s] = light_precision.rounded(Vec<3, float>(found.mean));
      if (!back) {
        result.radiance_error[s] = error_precision.rounded(std::sqrt(found.variance));
      }
    });
    // A side without maps has no direct light.
    if (!result.derives_radiance(back)) (back ? result.radiance_back : result.radiance) = means;
  }
  measure_noise(light[0].averages);
  scene_.progress.check();
  return result;
}

// Returns the light of white isosurfaces, by side.
template <int D>
std::array<NoisyLight, 2> TexelLight<D>::filtered_light(UnfilteredLight<D>& unfiltered) {
  std::array<NoisyLight, 2> light;
  if (!indirect_) return light;
  const IndexedLattice<D>& texels = indirect_->texels();
  unfiltered.lattice = texels.lattice;
  for (std::size_t side = 0; side < (scene_.plan.back ? 2 : 1); ++side) {
    light[side] = {indirect_->averages(side != 0), indirect_->halves(side != 0)};
    if (previous_) previous_->blend(light[side], indirect_->blocks(), side != 0);
    unfiltered.sides[side] = packed(known_means(light[side].averages), unfiltered_precision);
    pool_variances(texels.lattice, light[side].averages, scene_.progress);
  }
  filter_along_isosurfaces(texels, surfaces(), light, scene_.progress);
  return light;
}

template <int D>
std::vector<Rgb> TexelLight<D>::direct_at(const TexelLattice<D>& lattice, bool back) const {
  std::vector<Rgb> found(lattice.active.size(), Rgb(0));
  if (back && !direct_->has_back()) return found;
  const Field<D>& field = volume_.volume().field;
  parallel_each(found.size(), 1024, scene_.progress, [&](std::size_t s) {
    found[s] = direct_->radiance(field, lattice.center(lattice.active[s]), back);
  });
  return found;
}

// Returns the indirect light of the scene's isosurfaces at a texel of the result, from that of
// white ones. Lookups multiply it by the texture at the point itself, which may change within a
// texel.
template <int D>
Average TexelLight<D>::finished(const std::vector<Average>& white, std::size_t slot) const {
  const Volume<D>& volume = volume_.volume();
  const Rgb albedo = texel_albedo(volume, texels_.lattice, slot);
  Average found;
  if (indirect_) found = interpolated(lattice(), white, texels_.lattice, slot);
  found.mean *= albedo;
  const auto scale = static_cast<float>(average(albedo));
  found.variance *= scale * scale;
  found.mean +=
      texel_emission(volume, volume_.tracer.scene().isovalue_range, texels_.lattice, slot);
  return found;
}

template <int D>
void TexelLight<D>::measure_noise(const std::vector<Average>& white) {
  const double exposure2 = scene_.settings.exposure * scene_.settings.exposure;
  errors_ = IsovalueErrors(volume_.tracer.scene().isovalue_range);
  for (const AreaPoint<D>& point : area_points(volume_, texels_.lattice, scene_.settings.seed)) {
    const TexelWeights<D> near =
        surface_weights(volume_.volume().field, texels_.lattice, point.position);
    double color = 0, deviation = 0;
    for (int i = 0; i < near.count; ++i) {
      const double w = near.weight[i];
      const Average m = finished(white, near.slot[i]);
      const Vec<D> center = texels_.lattice.center(texels_.lattice.active[near.slot[i]]);
      color += w * average(direct_->radiance(volume_.volume().field, center, false) + m.mean);
      deviation += w * std::sqrt(m.variance);
    }
    const double texture = average(volume_.volume().texture_at(point.position));
    color *= texture;
    deviation *= texture;
    // Errors of colors brighter than white are invisible.
    const bool is_white = color * scene_.settings.exposure > 1;
    errors_.add_noise(point.c, point.area, is_white ? 0 : exposure2 * deviation * deviation);
  }
}

template class TexelLight<2>;
template class TexelLight<3>;

}  // namespace leaflight
