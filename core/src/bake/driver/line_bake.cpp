// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/line_bake.h"

#include <sstream>

#include "bake/indirect/later_bounces.h"
#include "bake/indirect/sharpened_light.h"
#include "bake/texels/pooled_variance.h"
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
                      const Workers* workers)
    : scene_(scene),
      light_(scene, 0, texels, previous, previous ? bounces + previous->blocks() : 0),
      indirect_(light_.indirect()),
      workers_(workers),
      photons_(std::move(texels.photons), texels.wall_samples) {
  if (scene.split.wide) sky_.emplace(*scene.split.wide);
  if (!indirect_) return;
  if (volume().texture) compute_texture();
  if (texels.photon_count > 0) find_photons(texels.photon_count);
}

template <int D>
void LineBake<D>::compute_texture() {
  const TexelLattice<D>& lattice = light_.lattice();
  texture_.resize(lattice.active.size());
  parallel_each(texture_.size(), 2048, scene_.progress, [&](std::size_t s) {
    texture_[s] = volume().texture->at(lattice.center(lattice.active[s]));
  });
}

template <int D>
void LineBake<D>::add(int blocks, const std::function<bool()>& go_on) {
  if (!indirect_) return;
  scene_.progress.begin("Indirect light");
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
  SharedParts shared;
  if (workers_ && blocks > 0 && !stopped) {
    std::vector<BakePart> parts(blocks, {PartKind::block});
    for (int i = 0; i < blocks; ++i) parts[i].number = indirect_->next_block() + i;
    send(PartData::lines, [this](Archive archive) { serialize_lines(archive, false); });
    shared = SharedParts(*workers_, std::move(parts));
  }
  for (int i = 0; i < blocks && !stopped; ++i) {
    std::optional<std::string> bytes;
    if (workers_) bytes = shared.take(i, indirect_->cost(), scene_.progress);
    if (bytes) {
      indirect_->add_traced(*bytes, scene_.progress);
    } else {
      indirect_->add_block(gathered(), scene_.progress);
    }
    stopped = ended();
  }
  release();
}

template <int D>
void LineBake<D>::send(PartData kind, const std::function<void(Archive)>& write) const {
  workers_->send(kind, [&](std::ostream& stream) { write(Archive(stream)); });
}

template <int D>
void LineBake<D>::gather_bounces() {
  if (!workers_) return gather_bounces_here();
  send(PartData::lines, [this](Archive archive) { serialize_lines(archive, true); });
  const SharedParts shared(*workers_, {{PartKind::bounces}});
  const std::optional<std::string> bytes = shared.take(0, indirect_->cost(), scene_.progress);
  if (!bytes) return gather_bounces_here();
  std::size_t at = 0;
  for (int side = 0; side < scene_.sides(); ++side) {
    std::vector<Rgb>& light = indirect_sides_[side];
    copy_items(*bytes, at, light.data(), light.size());
    at += light.size() * sizeof(Rgb);
  }
  indirect_->go_to_block(bounces);
}

// Computes the first bounces, each from the one before. Sides for which lines do not gather keep
// their photon light.
template <int D>
void LineBake<D>::gather_bounces_here() {
  static const DirectLookup<D> no_direct;
  static const std::vector<char> no_meshes;
  const int sides = scene_.sides();
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
  direct_lookup_.reset();
}

template <int D>
void LineBake<D>::serialize(Archive& archive) {
  if (!indirect_) return;
  light_.serialize(archive);
  const std::size_t texels = light_.lattice().active.size();
  for (std::vector<Rgb>& side : indirect_sides_) archive(side, texels);
  archive(back_direct_, texels);
}

// Transfers the light that lines and walls look up to a worker, which computes that of photons and
// the light before the first bounce itself.
template <int D>
void LineBake<D>::serialize_lines(Archive& archive, bool is_dark) {
  archive(is_dark);
  archive(scene_.wall_detail.samples);
  if (archive.restores()) wall_parts_.reset();
  if (!indirect_) return;
  const std::size_t texels = light_.lattice().active.size();
  if (archive.restores()) {
    has_lines_ = true;
    indirect_sides_ = {};
    compute_indirect_sides();
  }
  for (int side = 0; side < scene_.sides() && !is_dark; ++side) {
    archive(indirect_sides_[side], texels);
  }
  archive(back_direct_, texels);
}

template <int D>
void LineBake<D>::read(PartData kind, std::istream& stream) {
  Archive archive(stream);
  if (kind == PartData::photons) {
    photons_.serialize(archive, scene_.tracer);
  } else {
    serialize_lines(archive, false);
  }
}

template <int D>
std::string LineBake<D>::traced(const BakePart& part) {
  if (part.kind == PartKind::photons) {
    trace_photons(part.number, part.end);
    std::ostringstream stream;
    photons_.serialize(Archive(stream), scene_.tracer);
    return std::move(stream).str();
  }
  if (part.kind == PartKind::walls) {
    make_wall_parts();
    compute_radiance();
    return wall_parts_->traced(part, scene_.progress);
  }
  if (!indirect_ || !has_lines_) {
    throw Error("A part of indirect light needs what its lines look up.");
  }
  if (part.kind == PartKind::block) {
    return indirect_->traced_block(part.number, gathered(), scene_.progress);
  }
  // Keep what was sent, because the part may be traced again.
  const std::array<std::vector<Rgb>, 2> sent = indirect_sides_;
  indirect_->go_to_block(0);
  gather_bounces_here();
  indirect_->release();
  std::string bytes = bytes_of(indirect_sides_[0]);
  if (scene_.plan.back) bytes += bytes_of(indirect_sides_[1]);
  indirect_sides_ = sent;
  return bytes;
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
  make_wall_parts();
  if (indirect_) compute_indirect_sides();
  WallsOfOthers others;
  if (workers_) {
    send(PartData::lines, [this](Archive archive) { serialize_lines(archive, false); });
    others = [this](const std::vector<BakePart>& parts) { return walls_of_workers(parts); };
  } else {
    compute_radiance();
  }
  WallRadiance<D> walls = wall_parts_->radiance(scene_.direct_of_walls, scene_.progress, others);
  wall_parts_.reset();
  isosurfaces_.clear();
  indirect_sides_ = {};
  return walls;
}

template <int D>
std::vector<std::string> LineBake<D>::walls_of_workers(const std::vector<BakePart>& parts) {
  const SharedParts shared(*workers_, parts);
  std::vector<std::string> found;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::optional<std::string> bytes = shared.take(i, wall_parts_->work(parts[i]), scene_.progress);
    if (!bytes) {
      compute_radiance();
      bytes = wall_parts_->traced(parts[i], scene_.progress);
    }
    found.push_back(*std::move(bytes));
  }
  return found;
}

// Prepares paths from walls, but not the light that they look up.
template <int D>
void LineBake<D>::make_wall_parts() {
  if (wall_parts_) return;
  isosurfaces_ = std::vector<IsosurfaceRadiance<D>>(1);
  if (indirect_) {
    isosurfaces_[0].lattice = &light_.lattice();
    gather_ = make_gather_estimator(scene_.tracer, scene_.lights, isosurfaces_, *photons_.walls());
  }
  const PointSampler<D> sampler{scene_.lights, isosurfaces_, photons_.walls(), false};
  wall_parts_ = std::make_unique<WallParts<D>>(
      WallSources<D>{scene_.tracer, scene_.subdivided(), sampler, gather_.get(),
                     scene_.wall_detail.samples, scene_.settings.seed});
}

// Computes the light of the isosurfaces that paths from walls look up, once.
template <int D>
void LineBake<D>::compute_radiance() {
  if (!indirect_ || !isosurfaces_[0].radiance[0].empty()) return;
  const TexelLattice<D>& lattice = light_.lattice();
  for (int side = 0; side < 2; ++side) {
    std::vector<Rgb>& all = isosurfaces_[0].radiance[side];
    all.assign(lattice.active.size(), Rgb(0));
    if (side < scene_.sides()) all = light_.direct_at(lattice, side != 0);
    parallel_each(indirect_sides_[side].size(), [&](std::size_t s) {
      all[s] += indirect_sides_[side][s] * texel_albedo(volume(), lattice, s);
    });
    for (std::size_t s = 0; s < texture_.size(); ++s) all[s] *= texture_[s];
  }
}

template <int D>
void LineBake<D>::find_photons(std::uint64_t count) {
  BakePart all{PartKind::photons};
  all.number = light_.blocks();
  all.end = count;
  std::optional<std::string> bytes;
  if (workers_) {
    scene_.progress.begin("Tracing photons");
    const double work = scene_.plan.photons ? rays_per_photon * static_cast<double>(count) : 0;
    bytes = SharedParts(*workers_, {all}).take(0, work, scene_.progress);
  }
  if (!bytes) {
    trace_photons(all.number, count);
  } else {
    std::istringstream stream(*bytes);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    photons_.serialize(Archive(stream), scene_.tracer);
  }
  if (!workers_) return;
  send(PartData::photons, [this](Archive archive) { photons_.serialize(archive, scene_.tracer); });
}

template <int D>
void LineBake<D>::trace_photons(int number, std::uint64_t count) {
  // A continued bake traces new photons, because the noise of the walls' light is in all lines.
  const std::uint64_t seed = random_for(scene_.settings.seed, Purpose::photon, number).bits();
  photons_.trace(scene_.tracer, scene_.lights, scene_.plan, count, seed, scene_.progress);
}

template <int D>
void LineBake<D>::compute_direct_lookup() {
  if (direct_lookup_) return;
  direct_lookup_.emplace(light_.volume(), light_.lattice(), light_.direct(), scene_.progress);
}

// Computes the indirect light that lines look up. Photons light the back if no lines gather for it.
template <int D>
void LineBake<D>::compute_indirect_sides() {
  for (const bool back : {false, true}) {
    std::vector<Rgb>& light = indirect_sides_[back];
    if (gathers(back) && light_.has_blocks()) {
      light = looked_up(light_.averages(back));
    } else if (gathers(back)) {
      light.assign(light_.lattice().active.size(), Rgb(0));
    } else if (light.empty()) {
      light = photons_.backs(light_.lattice());
    }
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
  compute_direct_lookup();
  return {light_.surfaces(),
          {&indirect_sides_[0], &indirect_sides_[1]},
          scene_.plan.back ? &back_direct_ : nullptr,
          texture_,
          *direct_lookup_,
          photons_.walls(),
          scene_.split.mesh_is_wide,
          sky_ ? &*sky_ : nullptr,
          true};
}

template class LineBake<2>;
template class LineBake<3>;

}  // namespace leaflight
