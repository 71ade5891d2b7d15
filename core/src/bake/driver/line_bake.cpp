// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/line_bake.h"

#include <cmath>
#include <limits>

#include "bake/indirect/later_bounces.h"
#include "bake/indirect/sharpened_light.h"
#include "bake/texels/area_points.h"
#include "bake/texels/pooled_variance.h"
#include "bake/walls/light_walls.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/release.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

// Numbers of directions of the first bounces of indirect light, before blocks count. Later bounces
// add less light and less variance. Bounces start without photon light: it is too coarse, and light
// that leaks through a wall stays in a closed cavity for many bounces.
constexpr std::array bounce_directions{16, 8, 4, 4};
constexpr int bounces = bounce_directions.size();

template <int D>
Rgb emission_near(const Volume<D>& volume, const IsovalueRange& isovalue_range,
                  const Vec<D>& index_position) {
  if (!(volume.emission.largest() > 0)) return Rgb(0);
  const CellPoint<D> at = locate(volume.field, index_position);
  const double h = interpolate(load_corners(volume.field, at.cell), at.local);
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
LineBake<D>::LineBake(LitScene<D>& scene, std::size_t volume, BakeTexels<D> texels,
                      const PreviousLight<D>* previous, const BlockWorkers* workers)
    : scene_(scene),
      volume_(scene.volumes[volume]),
      lights_(scene.lights),
      split_(scene.split),
      direct_(scene.direct[volume]),
      settings_(scene.settings),
      plan_(scene.plan),
      progress_(scene.progress),
      previous_(previous),
      workers_(workers),
      texels_(std::move(texels.shown)),
      errors_(volume_.tracer.scene().isovalue_range) {
  if (split_.wide) sky_.emplace(*split_.wide);
  if (!plan_.indirect) return;
  indirect_ = std::make_unique<IndirectLight<D>>(volume_, std::move(texels.indirect),
                                                 texels.spacing, plan_.back, settings_.seed,
                                                 previous ? bounces + previous->blocks() : 0);
  // Paths look up the texture at their points.
  if (plan_.lines && volume_.volume().texture) compute_texture();
  if (texels.photon_count > 0) trace_photons(texels);
}

template <int D>
void LineBake<D>::compute_texture() {
  const TexelLattice<D>& lattice = indirect_->texels().lattice;
  texture_.resize(lattice.active.size());
  parallel_range(texture_.size(), 2048, 0, progress_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      texture_[s] = volume_.volume().texture->at(lattice.center(lattice.active[s]));
    }
  });
}

template <int D>
void LineBake<D>::add(int blocks, const std::function<bool()>& go_on) {
  if (!indirect_) return;
  progress_.begin("Indirect light");
  compute_direct_lookup();
  const auto ended = [&] { return go_on && !go_on(); };
  bool stopped = false;
  // After an interrupted add(), these are already computed.
  if (indirect_sides_[0].empty()) {
    compute_back_direct();
    compute_indirect_sides();
    if (this->blocks() == 0) {
      gather_bounces();
      stopped = ended();
    }
  }
  if (workers_ && blocks > 0 && !stopped) {
    workers_->begin(indirect_->next_block(), blocks, [this](std::ostream& stream) {
      Archive archive(stream);
      serialize_lookups(archive);
    });
  }
  for (int i = 0; i < blocks && !stopped; ++i) {
    const std::string bytes = workers_ ? workers_->take(indirect_->next_block()) : std::string();
    if (bytes.empty()) {
      indirect_->add_block(gathered(), progress_);
    } else {
      indirect_->add_block_of_others(bytes, progress_);
    }
    stopped = ended();
  }
  release();
}

// Computes the first bounces, each from the one before. Sides for which lines do not gather keep
// their photon light.
template <int D>
void LineBake<D>::gather_bounces() {
  static const DirectLookup<D> no_direct;
  static const std::vector<char> no_meshes;
  const int sides = plan_.back ? 2 : 1;
  std::array<std::vector<Rgb>, 2> bounce, before;
  for (int i = 0; i < bounces; ++i) {
    const GatheredRadiance<D> reflected{surfaces_, {&before[0], &before[1]},
                                        nullptr,   texture_,
                                        no_direct, nullptr,
                                        no_meshes, nullptr,
                                        false};
    indirect_->add_block(i == 0 ? gathered() : reflected, progress_, bounce_directions[i]);
    for (int side = 0; side < sides; ++side) {
      bounce[side] = looked_up(indirect_->averages(side != 0));
      const bool is_last = i + 1 == bounces;
      const Rgb share = is_last ? Rgb(1) + later_bounces(before[side], bounce[side]) : Rgb(1);
      parallel_each(bounce[side].size(),
                    [&](std::size_t s) { indirect_sides_[side][s] += bounce[side][s] * share; });
    }
    indirect_->clear();
    std::swap(before, bounce);
  }
}

template <int D>
void LineBake<D>::add_block(const std::function<void(SideMoments&)>& fill) {
  indirect_->add_block_by(fill, progress_);
}

// Frees the inputs of the lines, which take as much memory as the result.
template <int D>
void LineBake<D>::release() {
  indirect_->release();
  leaflight::release(back_direct_);
  indirect_sides_ = {};
  direct_lookup_ = {};
}

template <int D>
void LineBake<D>::serialize(Archive& archive) {
  if (!indirect_) return;
  indirect_->serialize(archive);
  serialize_indirect(archive);
}

template <int D>
void LineBake<D>::serialize_indirect(Archive& archive) {
  const std::size_t texels = indirect_->texels().lattice.active.size();
  for (std::vector<Rgb>& side : indirect_sides_) archive(side, texels);
  archive(back_direct_, texels);
}

template <int D>
void LineBake<D>::serialize_lookups(Archive& archive) {
  serialize_indirect(archive);
  bool walls = photons_.walls != nullptr;
  archive(walls);
  if (archive.restores()) {
    compute_direct_lookup();
    if (walls && !photons_.walls) {
      photons_.walls = std::make_unique<SurfaceCache<D>>(volume_.tracer, false, 1.0, 0, true);
    }
  }
  if (walls) {
    std::vector<Rgb>& radiance = photons_.walls->finished();
    archive(radiance, radiance.size());
  }
}

template <int D>
std::string LineBake<D>::traced_block(int number) {
  if (!indirect_ || indirect_sides_[0].empty()) {
    throw Error("A block of indirect light needs what its lines look up.");
  }
  return indirect_->traced_block(number, gathered(), progress_);
}

template <int D>
std::vector<RadianceGrid<D>> LineBake<D>::grids() {
  std::vector<RadianceGrid<D>> grids;
  grids.push_back(grid());
  return grids;
}

template <int D>
RadianceGrid<D> LineBake<D>::grid() {
  progress_.begin("Lighting texels");
  SideAverages indirect;
  UnfilteredLight<D> unfiltered;
  const std::size_t sides = plan_.back ? 2 : 1;
  std::array<NoisyLight, 2> light = filtered_light(unfiltered);
  for (std::size_t side = 0; side < sides; ++side) {
    const bool back = side != 0;
    if (direct_texels_[side].empty()) direct_texels_[side] = direct_at(texels_.lattice, back);
    if (indirect_) {
      indirect[side] = interpolated(indirect_->texels().lattice, light[side].averages,
                                    texels_.lattice, progress_);
    } else {
      indirect[side].resize(direct_texels_[side].size());
    }
    light[side] = {};
    finish(indirect[side]);
  }
  progress_.check();
  measure_noise(indirect[0]);
  progress_.check();
  RadianceGrid<D> result =
      make_grid<D>(texels_.lattice, direct_texels_, std::move(indirect), direct_);
  result.texture = volume_.volume().texture;
  result.unfiltered = std::move(unfiltered);
  return result;
}

// Returns the light of white isosurfaces, by side.
template <int D>
std::array<NoisyLight, 2> LineBake<D>::filtered_light(UnfilteredLight<D>& unfiltered) {
  std::array<NoisyLight, 2> light;
  if (!indirect_) return light;
  const IndexedLattice<D>& texels = indirect_->texels();
  unfiltered.resolution = texels.lattice.resolution;
  unfiltered.texels = texels.lattice.active;
  for (std::size_t side = 0; side < (plan_.back ? 2 : 1); ++side) {
    light[side] = {indirect_->averages(side != 0), indirect_->halves(side != 0)};
    if (previous_) previous_->blend(light[side], indirect_->blocks(), side != 0);
    unfiltered.sides[side] = packed(known_means(light[side].averages), unfiltered_precision);
    pool_variances(texels.lattice, light[side].averages, progress_);
  }
  compute_surfaces();
  filter_along_isosurfaces(texels, surfaces_, light, progress_);
  return light;
}

template <int D>
WallRadiance<D> LineBake<D>::walls() {
  progress_.begin("Lighting walls");
  std::vector<IsosurfaceRadiance<D>> isosurfaces(1);
  std::unique_ptr<IndirectEstimator<D>> estimator;
  if (indirect_) {
    const TexelLattice<D>& lattice = indirect_->texels().lattice;
    compute_indirect_sides();
    isosurfaces[0].lattice = &lattice;
    isosurfaces[0].photons = photons_.isosurfaces[0].get();
    for (int side = 0; side < 2; ++side) {
      std::vector<Rgb>& all = isosurfaces[0].radiance[side];
      all.assign(lattice.active.size(), Rgb(0));
      if (side == 0 || plan_.back) {
        all = direct_at(lattice, side != 0);
      }
      parallel_each(indirect_sides_[side].size(), [&](std::size_t s) {
        all[s] += indirect_sides_[side][s] *
                  albedo_near(volume_.volume(), lattice.center(lattice.active[s]));
      });
      for (std::size_t s = 0; s < texture_.size(); ++s) all[s] *= texture_[s];
    }
    estimator = make_gather_estimator(volume_.tracer, lights_, isosurfaces, *photons_.walls);
  }
  const PointSampler<D> sampler{lights_, isosurfaces, photons_.walls.get(), false};
  return light_walls(volume_.tracer, sampler, estimator.get(), scene_.subdivided(),
                     scene_.direct_of_walls, scene_.wall_detail.samples, settings_.seed, progress_);
}

template <int D>
void LineBake<D>::trace_photons(const BakeTexels<D>& texels) {
  PhotonSettings settings;
  // A continued bake traces new photons, because the noise of the walls' cache is in all of its
  // lines.
  const std::uint64_t before = previous_ ? previous_->blocks() : 0;
  settings.seed = random_for(settings_.seed, Purpose::photon, before).bits();
  settings.photons = texels.photon_count;
  settings.wall_samples = texels.wall_samples;
  settings.smooth_walls = true;
  lattices_ = {texels.photons};
  photons_ = trace_into_caches(volume_.tracer, lights_, lattices_, settings, plan_, progress_);
}

template <int D>
std::vector<Rgb> LineBake<D>::indirect_of_photons(bool back) const {
  const TexelLattice<D>& texels = lattices_[0];
  const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
  std::vector<Average> known(texels.active.size());
  parallel_each(known.size(), [&](std::size_t s) {
    known[s].mean = photons_.isosurfaces[0]->irradiance(static_cast<std::int32_t>(s), back) * brdf;
  });
  known = interpolated(texels, known, indirect_->texels().lattice, progress_);
  std::vector<Rgb> indirect(known.size());
  parallel_each(known.size(), [&](std::size_t s) { indirect[s] = known[s].mean; });
  return indirect;
}

template <int D>
std::vector<Rgb> LineBake<D>::direct_at(const TexelLattice<D>& lattice, bool back) const {
  std::vector<Rgb> found(lattice.active.size(), Rgb(0));
  if (back && !direct_->has_back()) return found;
  const Field<D>& field = volume_.volume().field;
  parallel_range(found.size(), 1024, 0, progress_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      found[s] = direct_->radiance(field, lattice.center(lattice.active[s]), back);
    }
  });
  return found;
}

template <int D>
void LineBake<D>::compute_direct_lookup() {
  if (direct_lookup_.sources() == 0) {
    direct_lookup_ = DirectLookup<D>(volume_, indirect_->texels().lattice, *direct_, progress_);
  }
  compute_surfaces();
}

template <int D>
void LineBake<D>::compute_surfaces() {
  if (surfaces_.empty())
    surfaces_ = texel_surfaces(volume_, indirect_->texels().lattice, progress_);
}

// Computes the indirect light that lines look up. Photons light the back if no lines gather for it.
template <int D>
void LineBake<D>::compute_indirect_sides() {
  for (int side = 0; side < 2; ++side) {
    const bool gathers = side == 0 || plan_.back;
    if (!gathers || (!previous_ && indirect_->blocks() == 0)) {
      if (gathers) indirect_sides_[side].assign(indirect_->texels().lattice.active.size(), Rgb(0));
      if (indirect_sides_[side].empty()) indirect_sides_[side] = indirect_of_photons(side != 0);
      continue;
    }
    NoisyLight light{indirect_->averages(side != 0), {}};
    if (previous_) previous_->blend(light, indirect_->blocks(), side != 0);
    indirect_sides_[side] = looked_up(light.averages);
  }
}

// Returns the light of texels for hits, which read it by random linear interpolation.
template <int D>
std::vector<Rgb> LineBake<D>::looked_up(const std::vector<Average>& averages) {
  const IndexedLattice<D>& texels = indirect_->texels();
  return sharpened(texels, filled_means(texels.lattice, averages, progress_), progress_);
}

template <int D>
void LineBake<D>::compute_back_direct() {
  if (!plan_.back) return;
  back_direct_ = direct_at(indirect_->texels().lattice, true);
}

template <int D>
GatheredRadiance<D> LineBake<D>::gathered() const {
  return {surfaces_,
          {&indirect_sides_[0], &indirect_sides_[1]},
          plan_.back ? &back_direct_ : nullptr,
          texture_,
          direct_lookup_,
          photons_.walls.get(),
          split_.mesh_is_wide,
          sky_ ? &*sky_ : nullptr,
          true};
}

// Converts light of white isosurfaces to light of the scene's isosurfaces. Lookups multiply it by
// the texture at the point itself, which may change within a texel.
template <int D>
void LineBake<D>::finish(std::vector<Average>& indirect) const {
  const Volume<D>& volume = volume_.volume();
  const IsovalueRange& isovalue_range = volume_.tracer.scene().isovalue_range;
  parallel_each(indirect.size(), [&](std::size_t s) {
    const Vec<D> center = texels_.lattice.center(texels_.lattice.active[s]);
    const Rgb albedo = albedo_near(volume, center);
    indirect[s].mean *= albedo;
    const auto scale = static_cast<float>(average(albedo));
    indirect[s].variance *= scale * scale;
    indirect[s].mean += emission_near(volume, isovalue_range, center);
  });
}

template <int D>
void LineBake<D>::measure_noise(const std::vector<Average>& indirect) {
  const double exposure2 = settings_.exposure * settings_.exposure;
  errors_ = IsovalueErrors(volume_.tracer.scene().isovalue_range);
  for (const AreaPoint<D>& point : area_points(volume_, texels_.lattice, settings_.seed)) {
    const TexelWeights<D> near = linear_weights(texels_.lattice, point.position);
    double color = 0, deviation = 0;
    for (int i = 0; i < near.count; ++i) {
      const double w = near.weight[i];
      const Average& m = indirect[near.slot[i]];
      color += w * average(direct_texels_[0][near.slot[i]] + m.mean);
      deviation += w * std::sqrt(m.variance);
    }
    const double texture = average(volume_.volume().texture_at(point.position));
    color *= texture;
    deviation *= texture;
    // Errors of colors brighter than white are invisible.
    const bool is_white = color * settings_.exposure > 1;
    errors_.add_noise(point.c, point.area, is_white ? 0 : exposure2 * deviation * deviation);
  }
}

template class LineBake<2>;
template class LineBake<3>;

}  // namespace leaflight
