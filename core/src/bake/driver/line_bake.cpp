// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/line_bake.h"

#include "bake/indirect/later_bounces.h"
#include "bake/indirect/sharpened_light.h"
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

}  // namespace

template <int D>
LineBake<D>::LineBake(LitScene<D>& scene, BakeTexels<D> texels, const PreviousLight<D>* previous,
                      const BlockWorkers* workers)
    : scene_(scene),
      light_(scene, 0, texels, previous, previous ? bounces + previous->blocks() : 0),
      indirect_(light_.indirect()),
      workers_(workers) {
  if (scene.split.wide) sky_.emplace(*scene.split.wide);
  if (!indirect_) return;
  if (volume().texture) compute_texture();
  if (texels.photon_count > 0) trace_photons(texels);
}

template <int D>
void LineBake<D>::compute_texture() {
  const TexelLattice<D>& lattice = light_.lattice();
  texture_.resize(lattice.active.size());
  parallel_range(texture_.size(), 2048, 0, scene_.progress,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t s = begin; s < end; ++s) {
                     texture_[s] = volume().texture->at(lattice.center(lattice.active[s]));
                   }
                 });
}

template <int D>
void LineBake<D>::add(int blocks, const std::function<bool()>& go_on) {
  if (!indirect_) return;
  scene_.progress.begin("Indirect light");
  compute_direct_lookup();
  const auto ended = [&] { return go_on && !go_on(); };
  bool stopped = false;
  // After an interrupted add(), these are already computed.
  if (indirect_sides_[0].empty()) {
    compute_back_direct();
    compute_indirect_sides();
    if (light_.blocks() == 0) {
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
      indirect_->add_block(gathered(), scene_.progress);
    } else {
      indirect_->add_block_of_others(bytes, scene_.progress);
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
  const int sides = scene_.plan.back ? 2 : 1;
  std::array<std::vector<Rgb>, 2> bounce, before;
  for (int i = 0; i < bounces; ++i) {
    const GatheredRadiance<D> reflected{light_.surfaces(),
                                        {&before[0], &before[1]},
                                        nullptr,
                                        texture_,
                                        no_direct,
                                        nullptr,
                                        no_meshes,
                                        nullptr,
                                        false};
    indirect_->add_block(i == 0 ? gathered() : reflected, scene_.progress, bounce_directions[i]);
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
  light_.serialize(archive);
  serialize_indirect(archive);
}

template <int D>
void LineBake<D>::serialize_indirect(Archive& archive) {
  const std::size_t texels = light_.lattice().active.size();
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
      photons_.walls = std::make_unique<SurfaceCache<D>>(scene_.tracer, false, 1.0, 0, true);
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
  return indirect_->traced_block(number, gathered(), scene_.progress);
}

template <int D>
std::vector<RadianceGrid<D>> LineBake<D>::grids() {
  std::vector<RadianceGrid<D>> grids;
  grids.push_back(light_.grid());
  return grids;
}

template <int D>
WallRadiance<D> LineBake<D>::walls() {
  scene_.progress.begin("Lighting walls");
  std::vector<IsosurfaceRadiance<D>> isosurfaces(1);
  std::unique_ptr<IndirectEstimator<D>> estimator;
  if (indirect_) {
    const TexelLattice<D>& lattice = light_.lattice();
    compute_indirect_sides();
    isosurfaces[0].lattice = &lattice;
    isosurfaces[0].photons = photons_.isosurfaces[0].get();
    for (int side = 0; side < 2; ++side) {
      std::vector<Rgb>& all = isosurfaces[0].radiance[side];
      all.assign(lattice.active.size(), Rgb(0));
      if (side == 0 || scene_.plan.back) {
        all = light_.direct_at(lattice, side != 0);
      }
      parallel_each(indirect_sides_[side].size(), [&](std::size_t s) {
        all[s] += indirect_sides_[side][s] * texel_albedo(volume(), lattice, s);
      });
      for (std::size_t s = 0; s < texture_.size(); ++s) all[s] *= texture_[s];
    }
    estimator = make_gather_estimator(scene_.tracer, scene_.lights, isosurfaces, *photons_.walls);
  }
  const PointSampler<D> sampler{scene_.lights, isosurfaces, photons_.walls.get(), false};
  return light_walls(scene_.tracer, sampler, estimator.get(), scene_.subdivided(),
                     scene_.direct_of_walls, scene_.wall_detail.samples, scene_.settings.seed,
                     scene_.progress);
}

template <int D>
void LineBake<D>::trace_photons(const BakeTexels<D>& texels) {
  PhotonSettings settings;
  // A continued bake traces new photons, because the noise of the walls' cache is in all of its
  // lines.
  settings.seed = random_for(scene_.settings.seed, Purpose::photon, light_.blocks()).bits();
  settings.photons = texels.photon_count;
  settings.wall_samples = texels.wall_samples;
  settings.smooth_walls = true;
  lattices_ = {texels.photons};
  photons_ = trace_into_caches(scene_.tracer, scene_.lights, lattices_, settings, scene_.plan,
                               scene_.progress);
}

template <int D>
std::vector<Rgb> LineBake<D>::indirect_of_photons(bool back) const {
  const TexelLattice<D>& texels = lattices_[0];
  const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
  std::vector<Average> known(texels.active.size());
  parallel_each(known.size(), [&](std::size_t s) {
    known[s].mean = photons_.isosurfaces[0]->irradiance(static_cast<std::int32_t>(s), back) * brdf;
  });
  std::vector<Rgb> indirect(light_.lattice().active.size());
  parallel_each(indirect.size(), [&](std::size_t s) {
    indirect[s] = interpolated(texels, known, light_.lattice(), s).mean;
  });
  return indirect;
}

template <int D>
void LineBake<D>::compute_direct_lookup() {
  if (direct_lookup_.sources() == 0) {
    direct_lookup_ =
        DirectLookup<D>(light_.volume(), light_.lattice(), light_.direct(), scene_.progress);
  }
}

// Computes the indirect light that lines look up. Photons light the back if no lines gather for it.
template <int D>
void LineBake<D>::compute_indirect_sides() {
  for (int side = 0; side < 2; ++side) {
    const bool gathers = side == 0 || scene_.plan.back;
    if (!gathers || !light_.has_blocks()) {
      if (gathers) indirect_sides_[side].assign(light_.lattice().active.size(), Rgb(0));
      if (indirect_sides_[side].empty()) indirect_sides_[side] = indirect_of_photons(side != 0);
      continue;
    }
    indirect_sides_[side] = looked_up(light_.averages(side != 0));
  }
}

// Returns the light of texels for hits, which read it by random linear interpolation.
template <int D>
std::vector<Rgb> LineBake<D>::looked_up(const std::vector<Average>& averages) {
  const IndexedLattice<D>& texels = indirect_->texels();
  return sharpened(texels, filled_means(texels.lattice, averages, scene_.progress),
                   scene_.progress);
}

template <int D>
void LineBake<D>::compute_back_direct() {
  if (!scene_.plan.back) return;
  back_direct_ = light_.direct_at(light_.lattice(), true);
}

template <int D>
GatheredRadiance<D> LineBake<D>::gathered() {
  return {light_.surfaces(),
          {&indirect_sides_[0], &indirect_sides_[1]},
          scene_.plan.back ? &back_direct_ : nullptr,
          texture_,
          direct_lookup_,
          photons_.walls.get(),
          scene_.split.mesh_is_wide,
          sky_ ? &*sky_ : nullptr,
          true};
}

template class LineBake<2>;
template class LineBake<3>;

}  // namespace leaflight
