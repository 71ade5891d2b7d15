// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/swept_bake.h"

#include <cmath>
#include <limits>

#include "bake/texels/pooled_variance.h"
#include "bake/walls/light_surroundings.h"
#include "math/error.h"
#include "math/sampling.h"

namespace leaflight {
namespace {

constexpr int wall_samples = 2, surroundings_samples = 16;
// How often the soft light that lines meet is gathered anew before it counts, each time along so
// many directions. It begins as none: what photons tell of it is too coarse, and what leaks through
// a wall stays in a closed cavity for many bounces.
constexpr int bounces = 2, bounce_directions = 8;
// The light of a bounce over that of the one before, at most: of what reflects all, it may be more
// by chance.
constexpr Real most_bounced = Real(0.8);

template <int D>
Rgb emission_near(const Volume<D>& volume, const IsovalueWindow& window,
                  const Vec<D>& index_position) {
  if (!(volume.emission.largest() > 0)) return Rgb(0);
  const CellPoint<D> at = locate(volume.field, index_position);
  const double h = interpolate(load_corners(volume.field, at.cell), at.local);
  const double c = std::isnan(h) ? window.min : volume.leaf_coordinate(h);
  return volume.emission.at(std::clamp(c, window.min, window.max));
}

Rgb mean_of(const std::vector<Rgb>& light) {
  Imath::V3d sum(0);
  for (const Rgb& one : light) sum += Imath::V3d(one);
  return light.empty() ? Rgb(0) : Rgb(sum / static_cast<double>(light.size()));
}

// Adds the bounces that are yet to come, as if all were a geometric series. `first`: the mean light
// of the first bounce; `light` has two.
void add_later_bounces(std::vector<Rgb>& light, const Rgb& first) {
  static_assert(bounces == 2);
  const Rgb mean = mean_of(light);
  Rgb scale(1);
  for (int i = 0; i < 3; ++i) {
    const Real second = std::max(Real(0), mean[i] - first[i]);
    if (!(first[i] > 0 && second > 0)) continue;
    const Real ratio = std::min(second / first[i], most_bounced);
    scale[i] += second / mean[i] * ratio / (1 - ratio);
  }
  for (Rgb& one : light) one *= scale;
}

}  // namespace

template <int D>
SweptBake<D>::SweptBake(LitScene<D>& scene, std::size_t volume, SweptTexels<D> texels,
                        const KeptLight<D>* kept, const BlockWorkers* workers)
    : volume_(scene.volumes[volume]),
      lights_(scene.lights),
      split_(scene.split),
      direct_(scene.direct[volume]),
      settings_(scene.settings),
      plan_(scene.plan),
      progress_(scene.progress),
      rays_(scene.rays),
      kept_(kept),
      workers_(workers),
      texels_(std::move(texels.shown)),
      errors_(volume_.tracer.scene().window) {
  if (split_.wide) sky_.emplace(*split_.wide);
  if (!plan_.indirect) return;
  indirect_ =
      std::make_unique<IndirectLight<D>>(volume_, std::move(texels.soft), texels.spacing,
                                         plan_.back, settings_.seed, kept ? 1 + kept->blocks() : 0);
  if (texels.photon_count > 0) trace_photons(texels.photons, texels.photon_count);
}

template <int D>
void SweptBake<D>::add(int blocks, const std::function<bool()>& go_on) {
  if (!indirect_) return;
  progress_.begin("Indirect light");
  // It is what it was where an interrupted add() goes on.
  if (soft_[0].empty()) {
    learn_inner_direct();
    learn_soft();
  }
  learn_leaf_light();
  const auto ended = [&] { return go_on && !go_on(); };
  bool stopped = false;
  while (!kept_ && bounces_ < bounces && !stopped) {
    const std::array<Rgb, 2> before{mean_of(soft_[0]), mean_of(soft_[1])};
    indirect_->add_block(gathered(), progress_, rays_, bounce_directions);
    learn_soft();
    const bool was_last = ++bounces_ == bounces;
    // All bounces are along the same directions, so that they compare.
    indirect_->clear(!was_last);
    if (was_last) {
      for (int side = 0; side < (plan_.back ? 2 : 1); ++side) {
        add_later_bounces(soft_[side], before[side]);
      }
    }
    stopped = ended();
  }
  if (workers_ && blocks > 0 && !stopped) {
    workers_->begin(indirect_->next_block(), blocks, [this](std::ostream& stream) {
      Keeper keeper(stream);
      keep_looked_up(keeper);
    });
  }
  for (int i = 0; i < blocks && !stopped; ++i) {
    const std::string bytes = workers_ ? workers_->take(indirect_->next_block()) : std::string();
    if (bytes.empty()) {
      indirect_->add_block(gathered(), progress_, rays_);
    } else {
      indirect_->add_block_of_others(bytes, progress_, rays_);
    }
    stopped = ended();
  }
  release();
}

template <int D>
void SweptBake<D>::add_block(const std::function<void(SideMoments&)>& fill) {
  indirect_->add_block_by(fill, progress_);
}

// What only lines look up takes as much memory as the result does.
template <int D>
void SweptBake<D>::release() {
  indirect_->release();
  inner_direct_ = {};
  soft_ = {};
  leaf_light_ = {};
}

template <int D>
void SweptBake<D>::keep(Keeper& keeper) {
  if (!indirect_) return;
  indirect_->keep(keeper);
  keeper(bounces_);
  keep_soft(keeper);
}

template <int D>
void SweptBake<D>::keep_soft(Keeper& keeper) {
  const std::size_t texels = indirect_->texels().lattice.active.size();
  for (std::vector<Rgb>& side : soft_) keeper(side, texels);
  keeper(inner_direct_, texels);
}

template <int D>
void SweptBake<D>::keep_looked_up(Keeper& keeper) {
  keep_soft(keeper);
  bool walls = photons_.surroundings != nullptr;
  keeper(walls);
  if (keeper.restores()) {
    learn_leaf_light();
    if (walls && !photons_.surroundings) {
      photons_.surroundings = std::make_unique<SurfaceCache<D>>(volume_.tracer, false, 1.0, 1);
    }
  }
  if (walls) {
    std::vector<Rgb>& radiance = photons_.surroundings->finished();
    keeper(radiance, radiance.size());
  }
}

template <int D>
std::string SweptBake<D>::sweep_for_others(int number) {
  if (!indirect_ || soft_[0].empty()) {
    throw Error("A block of indirect light needs what its lines look up.");
  }
  return indirect_->sweep_for_others(number, gathered(), progress_);
}

template <int D>
std::vector<RadianceGrid<D>> SweptBake<D>::grids() {
  std::vector<RadianceGrid<D>> grids;
  grids.push_back(grid());
  return grids;
}

template <int D>
RadianceGrid<D> SweptBake<D>::grid() {
  progress_.begin("Radiance of the texels");
  SideAverages direct, indirect;
  UnfilteredLight<D> unfiltered;
  const std::size_t sides = plan_.back ? 2 : 1;
  std::array<NoisyLight, 2> light = filtered_light(unfiltered);
  for (std::size_t side = 0; side < sides; ++side) {
    const bool inner = side != 0;
    direct[side] = direct_averages(inner);
    if (indirect_) {
      indirect[side] = interpolated(indirect_->texels().lattice, light[side].averages,
                                    texels_.lattice, progress_);
    } else {
      indirect[side].resize(direct[side].size());
    }
    light[side] = {};
    finish(indirect[side]);
  }
  progress_.check();
  measure_errors(direct[0], indirect[0]);
  progress_.check();
  RadianceGrid<D> result = make_grid<D>(std::move(direct), std::move(indirect));
  result.lattice = texels_.lattice;
  result.direct = direct_;
  result.unfiltered = std::move(unfiltered);
  return result;
}

// Of white leaves, by side.
template <int D>
std::array<NoisyLight, 2> SweptBake<D>::filtered_light(UnfilteredLight<D>& unfiltered) {
  std::array<NoisyLight, 2> light;
  if (!indirect_) return light;
  const SweptLattice<D>& texels = indirect_->texels();
  unfiltered.resolution = texels.lattice.resolution;
  unfiltered.texels = texels.lattice.active;
  for (std::size_t side = 0; side < (plan_.back ? 2 : 1); ++side) {
    light[side] = {indirect_->averages(side != 0), indirect_->halves(side != 0)};
    if (kept_) kept_->blend(light[side], indirect_->blocks(), side != 0);
    unfiltered.sides[side].reserve(light[side].averages.size());
    for (const Average& average : light[side].averages) {
      const Vec<3, float> unknown(std::numeric_limits<float>::quiet_NaN());
      unfiltered.sides[side].push_back(average.samples > 0 ? Vec<3, float>(average.mean) : unknown);
    }
    pool_variances(texels.lattice, light[side].averages, progress_);
    if (side == 0) measure_texture(light[side]);
  }
  if (surfaces_.empty()) surfaces_ = texel_surfaces(volume_, texels.lattice, progress_);
  filter_along_isosurfaces(texels, surfaces_, light, progress_);
  return light;
}

template <int D>
SurroundingsRadiance<D> SweptBake<D>::surroundings() {
  progress_.begin("Radiance of the surroundings");
  std::vector<LeafRadiance<D>> leaves(1);
  std::unique_ptr<IndirectEstimator<D>> estimator;
  if (indirect_) {
    const TexelLattice<D>& lattice = indirect_->texels().lattice;
    learn_soft();
    leaves[0].lattice = &lattice;
    leaves[0].photons = photons_.leaves[0].get();
    for (int side = 0; side < 2; ++side) {
      std::vector<Rgb>& all = leaves[0].radiance[side];
      all.assign(lattice.active.size(), Rgb(0));
      if (side == 0 || plan_.back) {
        all = direct_at(lattice, side != 0);
      }
      for (std::size_t s = 0; s < soft_[side].size(); ++s) {
        all[s] += soft_[side][s] * albedo_near(volume_.volume(), lattice.centre(lattice.active[s]));
      }
    }
    estimator = make_gather_estimator(volume_.tracer, lights_, leaves, *photons_.surroundings);
  }
  const PointSampler<D> sampler{lights_, leaves, photons_.surroundings.get(), false};
  return light_surroundings(volume_.tracer, sampler, estimator.get(), surroundings_samples,
                            settings_.seed, progress_, rays_);
}

template <int D>
void SweptBake<D>::trace_photons(const TexelLattice<D>& texels, std::uint64_t count) {
  PhotonSettings settings;
  settings.seed = settings_.seed;
  settings.photons = count;
  settings.wall_samples = wall_samples;
  lattices_ = {texels};
  photons_ =
      trace_into_caches(volume_.tracer, lights_, lattices_, settings, plan_, progress_, rays_);
}

template <int D>
std::vector<Rgb> SweptBake<D>::soft_of_photons(bool inner) const {
  const TexelLattice<D>& texels = lattices_[0];
  const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
  std::vector<Average> known(texels.active.size());
  for (std::size_t s = 0; s < known.size(); ++s) {
    known[s].mean = photons_.leaves[0]->irradiance(static_cast<std::int32_t>(s), inner) * brdf;
  }
  known = interpolated(texels, known, indirect_->texels().lattice, progress_);
  std::vector<Rgb> soft(known.size());
  for (std::size_t s = 0; s < known.size(); ++s) soft[s] = known[s].mean;
  return soft;
}

template <int D>
std::vector<Rgb> SweptBake<D>::direct_at(const TexelLattice<D>& lattice, bool inner) const {
  std::vector<Rgb> found(lattice.active.size(), Rgb(0));
  if (inner && !direct_->has_inner()) return found;
  const Field<D>& field = volume_.volume().field;
  parallel_range(found.size(), 1024, 0, progress_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      found[s] = direct_->radiance(field, lattice.centre(lattice.active[s]), inner);
    }
  });
  return found;
}

// Without an error.
template <int D>
std::vector<Average> SweptBake<D>::direct_averages(bool inner) {
  std::vector<Rgb>& known = direct_texels_[inner];
  if (known.empty()) known = direct_at(texels_.lattice, inner);
  std::vector<Average> averages(known.size());
  for (std::size_t s = 0; s < known.size(); ++s) averages[s].mean = known[s];
  return averages;
}

template <int D>
void SweptBake<D>::learn_leaf_light() {
  if (leaf_light_.sources() == 0) {
    leaf_light_ = LeafLight<D>(volume_, indirect_->texels(), *direct_, progress_);
  }
}

// Photons tell of the inner side where it is not swept.
template <int D>
void SweptBake<D>::learn_soft() {
  for (int side = 0; side < 2; ++side) {
    const bool swept = side == 0 || plan_.back;
    if (!swept || (!kept_ && indirect_->blocks() == 0)) {
      if (swept) soft_[side].assign(indirect_->texels().lattice.active.size(), Rgb(0));
      if (soft_[side].empty()) soft_[side] = soft_of_photons(side != 0);
      continue;
    }
    NoisyLight light{indirect_->averages(side != 0), {}};
    if (kept_) kept_->blend(light, indirect_->blocks(), side != 0);
    soft_[side] = filled_means(indirect_->texels().lattice, light.averages, progress_);
  }
}

template <int D>
void SweptBake<D>::learn_inner_direct() {
  if (!plan_.back) return;
  inner_direct_ = direct_at(indirect_->texels().lattice, true);
}

template <int D>
GatheredRadiance<D> SweptBake<D>::gathered() const {
  return {indirect_->texels(),         {&soft_[0], &soft_[1]}, &inner_direct_,         leaf_light_,
          photons_.surroundings.get(), split_.mesh_is_wide,    sky_ ? &*sky_ : nullptr};
}

// From white leaves to those of the scene.
template <int D>
void SweptBake<D>::finish(std::vector<Average>& indirect) const {
  const Volume<D>& of = volume_.volume();
  const IsovalueWindow& window = volume_.tracer.scene().window;
  for (std::size_t s = 0; s < indirect.size(); ++s) {
    const Vec<D> centre = texels_.lattice.centre(texels_.lattice.active[s]);
    const Rgb albedo = albedo_near(of, centre);
    indirect[s].mean *= albedo;
    const auto scale = static_cast<float>(average(albedo));
    indirect[s].variance *= scale * scale;
    indirect[s].mean += emission_near(of, window, centre);
  }
}

// From how far a texel is from the mean of its neighbours before and after along each axis, as two
// halves of the blocks tell it, whose product has no noise on average. Where light bends evenly,
// interpolation errs by a quarter of that distance at most; where it jumps, by half of it.
template <int D>
void SweptBake<D>::measure_texture(const NoisyLight& light) {
  constexpr float share = 0.5f;
  const SweptLattice<D>& texels = indirect_->texels();
  const TexelLattice<D>& lattice = texels.lattice;
  texture_.resize(lattice.active.size());
  parallel_range(texture_.size(), 2048, 0, progress_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Index<D> texel = lattice.texel(lattice.active[s]);
      const float p = light.halves[s].first_share;
      float sum = 0;
      for (int a = 0; a < D; ++a) {
        Index<D> before = texel, after = texel;
        if (--before[a] < 0 || ++after[a] >= lattice.resolution[a]) continue;
        const std::int32_t b = texels.slots[lattice.linear(before)];
        const std::int32_t c = texels.slots[lattice.linear(after)];
        if (b == TexelLattice<D>::inactive || c == TexelLattice<D>::inactive) continue;
        const Imath::V3f off(light.averages[s].mean -
                             (light.averages[b].mean + light.averages[c].mean) * Real(0.5));
        const HalfDifference &own = light.halves[s], &low = light.halves[b],
                             &high = light.halves[c];
        if (!(own.is_known && low.is_known && high.is_known)) continue;
        const Imath::V3f apart =
            own.first_less_second - (low.first_less_second + high.first_less_second) * 0.5f;
        sum += off.length2() + (1 - 2 * p) * off.dot(apart) - p * (1 - p) * apart.length2();
      }
      texture_[s] = share * share * sum / 3;
    }
  });
}

// At points of the leaves, as many for an area of leaves wherever it is.
template <int D>
void SweptBake<D>::measure_errors(const std::vector<Average>& direct,
                                  const std::vector<Average>& indirect) {
  constexpr std::size_t most_points = 1 << 16;
  const TexelLattice<D>& lattice = texels_.lattice;
  const Volume<D>& of = volume_.volume();
  const std::size_t step = 1 + lattice.active.size() / most_points;
  const double exposure2 = settings_.exposure * settings_.exposure;
  errors_ = LeafErrors(volume_.tracer.scene().window);
  for (std::size_t s = 0; s < direct.size(); s += step) {
    Random random = random_for(settings_.seed, Purpose::noise, s);
    Vec<D> position = lattice.centre(lattice.active[s]);
    for (int a = 0; a < D; ++a) {
      position[a] += (random.uniform() - 0.5) * lattice.voxels_per_texel[a];
    }
    const CellPoint<D> at = locate(of.field, position);
    const double h = interpolate(load_corners(of.field, at.cell), at.local);
    if (!volume_.window().contains(h)) continue;
    LeafError error;
    if (indirect_) {
      const SweptLattice<D>& soft = indirect_->texels();
      const std::int32_t near = soft.slot_near(position / soft.lattice.voxels_per_texel);
      const double albedo = average(albedo_near(of, position));
      if (near >= 0) error.texture = exposure2 * albedo * albedo * texture_[near];
    }
    const TexelWeights<D> near = linear_weights(lattice, position);
    double colour = 0, deviation = 0;
    for (int i = 0; i < (1 << D); ++i) {
      const double w = near.weight[i];
      if (!(w > 0)) continue;
      const Average &d = direct[near.slot[i]], &m = indirect[near.slot[i]];
      colour += w * average(d.mean + m.mean);
      deviation += w * std::sqrt(m.variance);
    }
    error.noise = exposure2 * deviation * deviation;
    // What is beyond white does not count.
    if (colour * settings_.exposure > 1) error = {};
    const double area = static_cast<double>(step) * shading_gradient(of.field, at).length();
    errors_.add(of.leaf_coordinate(h), area, error);
  }
}

template class SweptBake<2>;
template class SweptBake<3>;

}  // namespace leaflight
