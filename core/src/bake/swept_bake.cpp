// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/swept_bake.h"

#include <cmath>

#include "leaflight/bake/light_surroundings.h"
#include "leaflight/bake/pooled_variance.h"
#include "leaflight/math/error.h"
#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

constexpr int wall_samples = 2, surroundings_samples = 16;
// How often the soft light that lines meet is gathered anew before it counts, each time along so
// many directions: photons are too few to tell it by themselves.
constexpr int bounces = 3, bounce_directions = 16;

}  // namespace

template <int D>
SweptBake<D>::SweptBake(const SweptVolume<D>& volume, const LightSampler<D>& lights,
                        const BakeSettings<D>& settings, const Plan& plan, Progress& progress,
                        std::atomic<std::uint64_t>& rays, SweptTexels<D> texels,
                        const KeptLight<D>* kept, const BlockWorkers* workers)
    : volume_(volume),
      lights_(lights),
      settings_(settings),
      plan_(plan),
      progress_(progress),
      rays_(rays),
      kept_(kept),
      workers_(workers),
      texels_(std::move(texels.direct)),
      direct_(volume, lights, texels_, plan.back, settings.seed, kept ? kept->direct_blocks() : 0),
      errors_(volume.tracer.scene().window) {
  if (!plan.indirect) return;
  indirect_ = std::make_unique<IndirectLight<D>>(volume, std::move(texels.soft), texels.spacing,
                                                 plan.back, settings.seed,
                                                 kept ? bounces + kept->indirect_blocks() : 0);
  if (texels.photon_count > 0) trace_photons(texels.photons, texels.photon_count);
  if (!kept) return;
  for (int side = 0; side < (plan.back ? 2 : 1); ++side) {
    kept_soft_[side] = kept->soft(volume.volume(), volume.tracer.scene().window, side != 0,
                                  indirect_->texels().lattice, progress);
  }
}

template <int D>
void SweptBake<D>::add(int direct_blocks, int indirect_blocks,
                       const std::function<void()>& after_block) {
  progress_.begin("Direct light");
  direct_.add_blocks(direct_blocks, progress_, rays_, after_block, workers_);
  if (!indirect_) return;
  progress_.begin("Indirect light");
  // It is what it was where an interrupted add() goes on.
  if (soft_[0].empty()) {
    learn_inner_direct();
    learn_soft();
  }
  for (; !kept_ && bounces_ < bounces; ++bounces_) {
    indirect_->add_block(gathered(), progress_, rays_, bounce_directions);
    learn_soft();
    indirect_->clear();
  }
  if (workers_ && indirect_blocks > 0) {
    workers_->begin(SweptLight::indirect, indirect_->next_block(), indirect_blocks,
                    [this](std::ostream& stream) {
                      Keeper keeper(stream);
                      keep_looked_up(keeper);
                    });
  }
  for (int i = 0; i < indirect_blocks; ++i) {
    const std::string bytes =
        workers_ ? workers_->take(SweptLight::indirect, indirect_->next_block()) : std::string();
    if (bytes.empty()) {
      indirect_->add_block(gathered(), progress_, rays_);
    } else {
      indirect_->add_block_of_others(bytes, progress_, rays_);
    }
    if (after_block) after_block();
  }
  indirect_->release();
  // What only lines look up takes as much memory as the result does.
  inner_direct_ = {};
  soft_ = {};
}

template <int D>
void SweptBake<D>::keep(Keeper& keeper) {
  direct_.keep(keeper, progress_);
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
  int first_block = direct_.first_block();
  keeper(first_block);
  keep_soft(keeper);
  bool walls = photons_.surroundings != nullptr;
  keeper(walls);
  if (keeper.restores()) {
    direct_.learn_leaf_light(first_block, progress_);
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
std::string SweptBake<D>::sweep_for_others(SweptLight light, int number) {
  if (light == SweptLight::direct) return direct_.sweep_for_others(number, progress_);
  if (soft_[0].empty()) throw Error("A block of indirect light needs what its lines look up.");
  return indirect_->sweep_for_others(number, gathered(), progress_);
}

template <int D>
RadianceGrid<D> SweptBake<D>::grid() {
  progress_.begin("Radiance of the texels");
  SideAverages direct, indirect;
  const int sides = plan_.back ? 2 : 1;
  for (int side = 0; side < sides; ++side) {
    direct[side] = direct_.averages(side != 0);
    pool_variances(texels_.lattice, direct[side], progress_);
    if (!indirect_) {
      indirect[side].resize(direct[side].size());
    } else {
      const TexelLattice<D>& soft = indirect_->texels().lattice;
      std::vector<Average> averages = indirect_->averages(side != 0);
      pool_variances(soft, averages, progress_);
      indirect[side] = interpolated(soft, averages, texels_.lattice, progress_);
    }
    finish(indirect[side]);
    if (kept_) {
      kept_->add_to(direct[side], direct_.blocks(), indirect[side],
                    indirect_ ? indirect_->blocks() : 0, side != 0);
    }
  }
  progress_.check();
  measure_errors(direct[0], indirect[0]);
  progress_.check();
  RadianceGrid<D> result = make_grid<D>(std::move(direct), std::move(indirect));
  result.lattice = texels_.lattice;
  return result;
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
        const auto direct =
            interpolated(texels_.lattice, direct_means(side != 0), lattice, progress_);
        for (std::size_t s = 0; s < all.size(); ++s) all[s] = direct[s].mean;
      }
      for (std::size_t s = 0; s < soft_[side].size(); ++s) {
        all[s] += soft_[side][s] * albedo_near(volume_.volume(), lattice.centre(lattice.active[s]));
      }
    }
    estimator = make_gather_estimator(volume_.tracer, lights_, leaves, *photons_.surroundings);
  }
  const PointSampler<D> sampler{lights_, leaves, photons_.surroundings.get(), false};
  SurroundingsWork<D> work{refine(volume_.tracer.scene().meshes), surroundings_samples,
                           indirect_ ? 2.0 : 1.0, settings_.seed};
  return light_surroundings(volume_.tracer, sampler, estimator.get(), std::move(work), progress_,
                            rays_);
}

template <int D>
void SweptBake<D>::trace_photons(const TexelLattice<D>& texels, std::uint64_t count) {
  BakeSettings<D> settings = settings_;
  settings.photons = count;
  lattices_ = {texels};
  photons_ = trace_into_caches(volume_.tracer, lights_, lattices_, settings, plan_, wall_samples,
                               progress_, rays_);
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
std::vector<Average> SweptBake<D>::direct_means(bool inner) const {
  std::vector<Average> averages = direct_.averages(inner);
  if (kept_) kept_->add_to_direct(averages, direct_.blocks(), inner);
  return averages;
}

// Photons tell of what no sweep knows better.
template <int D>
void SweptBake<D>::learn_soft() {
  for (int side = 0; side < 2; ++side) {
    const bool swept = side == 0 || plan_.back;
    if (!swept || (!kept_ && indirect_->blocks() == 0)) {
      if (soft_[side].empty()) soft_[side] = soft_of_photons(side != 0);
      continue;
    }
    const std::vector<Average> averages = indirect_->averages(side != 0);
    soft_[side].resize(averages.size());
    for (std::size_t s = 0; s < averages.size(); ++s) {
      soft_[side][s] = averages[s].mean;
      if (!kept_) continue;
      const float w = kept_share(averages[s], indirect_->blocks(), kept_->indirect_blocks());
      soft_[side][s] = soft_[side][s] * (1 - w) + kept_soft_[side][s] * w;
    }
  }
}

template <int D>
void SweptBake<D>::learn_inner_direct() {
  if (!plan_.back) return;
  const std::vector<Average> averages =
      interpolated(texels_.lattice, direct_means(true), indirect_->texels().lattice, progress_);
  inner_direct_.clear();
  for (const Average& average : averages) inner_direct_.push_back(average.mean);
}

template <int D>
GatheredRadiance<D> SweptBake<D>::gathered() const {
  return {indirect_->texels(),
          {&soft_[0], &soft_[1]},
          &inner_direct_,
          direct_.leaf_light(),
          photons_.surroundings.get()};
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

// Squared, of a texel's colour: what texels miss of the light between them, from how far a texel is
// from the mean of its neighbours, of soft light those that are a texel of its own away. Where
// light bends evenly, interpolation errs by a quarter of that distance at most; where it jumps, by
// half of it. A third agrees with compare() on a bump box of 40^3 at one, half and a quarter voxel
// a texel. Neighbours' noise is in it: without it a bump box of 1.5 % would say 1.1.
template <int D>
double SweptBake<D>::texture_error(const std::vector<Average>& direct,
                                   const std::vector<Average>& indirect, std::size_t slot) const {
  constexpr double share = 1.0 / 3;
  const TexelLattice<D>& lattice = texels_.lattice;
  const Index<D> texel = lattice.texel(lattice.active[slot]);
  // From the mean of the neighbours so many texels before and after; zero beside inactive ones.
  const auto off = [&](const std::vector<Average>& light, int axis, int reach) {
    Index<D> before = texel, after = texel;
    before[axis] -= reach;
    after[axis] += reach;
    if (before[axis] < 0 || after[axis] >= lattice.resolution[axis]) return Rgb(0);
    const std::int32_t b = texels_.slots[lattice.linear(before)];
    const std::int32_t a = texels_.slots[lattice.linear(after)];
    if (b == TexelLattice<D>::inactive || a == TexelLattice<D>::inactive) return Rgb(0);
    return light[slot].mean - (light[b].mean + light[a].mean) * Real(0.5);
  };
  double sum = 0;
  for (int a = 0; a < D; ++a) {
    Rgb all = off(direct, a, 1);
    if (indirect_) {
      const double width = indirect_->texels().lattice.voxels_per_texel[a];
      const double reach = std::round(width / lattice.voxels_per_texel[a]);
      all += off(indirect, a, std::max(1, static_cast<int>(reach)));
    }
    // What is beyond white does not count.
    for (int i = 0; i < 3; ++i) {
      const double colour = settings_.exposure * (direct[slot].mean[i] + indirect[slot].mean[i]);
      if (colour < 1) sum += settings_.exposure * settings_.exposure * all[i] * all[i] / 3;
    }
  }
  return share * share * sum;
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
    error.texture = texture_error(direct, indirect, s);
    const TexelWeights<D> near = linear_weights(lattice, position);
    double colour = 0;
    for (int i = 0; i < (1 << D); ++i) {
      const double w = near.weight[i];
      if (!(w > 0)) continue;
      const Average &d = direct[near.slot[i]], &m = indirect[near.slot[i]];
      colour += w * average(d.mean + m.mean);
      error.direct += exposure2 * w * w * d.variance;
      error.indirect += exposure2 * w * w * m.variance;
    }
    // What is beyond white does not count.
    if (colour * settings_.exposure > 1) error.direct = error.indirect = 0;
    errors_.add(of.leaf_coordinate(h), shading_gradient(of.field, at).length(), error);
  }
}

template class SweptBake<2>;
template class SweptBake<3>;

}  // namespace leaflight
