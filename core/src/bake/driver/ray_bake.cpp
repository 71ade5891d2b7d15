// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/ray_bake.h"

#include "bake/driver/path_light.h"
#include "bake/texels/texel_samples.h"

namespace leaflight {
namespace {

// Paths in a block: per texel, and per vertex of the walls at a node.
constexpr int texel_samples = 1, vertex_samples = 4;

}  // namespace

template <int D>
RayBake<D>::RayBake(LitScene<D>& scene, std::vector<BakeTexels<D>> texels,
                    const std::vector<PreviousLight<D>>* previous)
    : scene_(scene),
      wide_(scene.tracer, scene.split),
      photons_(texels[0].photon_count),
      previous_blocks_(previous ? previous->front().blocks() : 0),
      errors_(scene.tracer.scene().isovalue_range) {
  for (std::size_t v = 0; v < texels.size(); ++v) {
    shown_.push_back(texels[v].shown.lattice.resolution);
    lattices_.push_back(texels[v].indirect.lattice);
    stored_.emplace_back();
    if (!scene.stores_light_of(v)) continue;
    stored_[v] = std::make_unique<TexelLight<D>>(scene, v, texels[v],
                                                 previous ? &(*previous)[v] : nullptr, 0);
  }
  if (scene.plan.walls) walls_.emplace(scene.tracer, scene.subdivided());
}

template <int D>
const LightSampler<D>& RayBake<D>::sampled(bool back) const {
  return back && stored_.size() > 1 ? scene_.lights : wide_;
}

template <int D>
double RayBake<D>::cost() const {
  double texels = 0;
  for (std::size_t v = 0; v < stored_.size(); ++v) {
    if (stored_[v]) texels += scene_.sides() * static_cast<double>(lattices_[v].active.size());
  }
  const double photons = scene_.plan.caustics ? static_cast<double>(photons_) : 0;
  return rays_per_photon * photons + texel_samples * texels +
         (walls_ ? walls_->work(vertex_samples) : 0);
}

template <int D>
void RayBake<D>::add(int blocks, const std::function<bool()>& go_on) {
  if (!scene_.plan.indirect) return;
  // The file of a previous bake has no blocks of the walls, so they are traced again.
  while (walls_ && walls_->blocks() < previous_blocks_) add_block(walls_->blocks(), false);
  for (int i = 0; i < blocks; ++i) {
    add_block(previous_blocks_ + blocks_, true);
    ++blocks_;
    if (go_on && !go_on()) break;
  }
  for (const auto& one : stored_) {
    if (one) one->indirect()->release();
  }
}

template <int D>
void RayBake<D>::add_block(int number, bool texels) {
  const std::uint64_t seed = random_for(scene_.settings.seed, Purpose::ray_block, number).bits();
  const PathLight<D> paths(scene_, lattices_, photons_, seed);
  const auto from = [&](bool back) { return paths.sampler(sampled(back)); };
  scene_.progress.begin("Indirect light");
  for (std::size_t v = 0; texels && v < stored_.size(); ++v) {
    if (!stored_[v]) continue;
    const auto fill = [&](SideMoments& moments) {
      for (int side = 0; side < scene_.sides(); ++side) {
        gather(v, side != 0, from(side != 0), paths.estimator(), seed, moments[side]);
      }
    };
    stored_[v]->indirect()->add_block_by(fill, scene_.progress);
  }
  if (walls_) {
    walls_->add(from(false), &paths.estimator(), {seed, vertex_samples}, scene_.progress);
  }
}

// Gathers light as if isosurfaces were white.
template <int D>
void RayBake<D>::gather(std::size_t volume, bool back, const PointSampler<D>& from,
                        const IndirectEstimator<D>& estimator, std::uint64_t seed,
                        TexelMoments& moments) {
  const TexelLattice<D>& lattice = lattices_[volume];
  const bool direct = from.lights.can_light();
  parallel_range(
      lattice.active.size(), 64, texel_samples, scene_.progress,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t rays = 0;
        for (std::size_t s = begin; s < end && !scene_.progress.cancelled(); ++s) {
          const std::uint32_t texel = lattice.active[s];
          const SampleKeys keys = sample_keys(seed, Purpose::texel, 2 * volume + back, texel);
          for_each_texel_sample(scene_.tracer, static_cast<int>(volume), back, lattice, texel,
                                texel_samples, keys.position, [&](SurfacePoint<D> point, int i) {
                                  point.albedo = Rgb(1);
                                  point.emission = Rgb(0);
                                  Rgb radiance = from.indirect(point, &estimator, keys, i, rays);
                                  if (direct) radiance += from.direct(point, keys, i, rays);
                                  moments.sums[s].add(Imath::V3f(radiance), 1);
                                });
        }
        scene_.progress.count_rays(rays);
      });
}

template <int D>
void RayBake<D>::serialize(Archive& archive) {
  archive(blocks_);
  for (const auto& one : stored_) {
    if (one) one->serialize(archive);
  }
  if (walls_) walls_->serialize(archive);
}

template <int D>
std::vector<RadianceGrid<D>> RayBake<D>::grids() {
  std::vector<RadianceGrid<D>> grids;
  errors_ = IsovalueErrors(scene_.tracer.scene().isovalue_range);
  bool any = false;
  for (std::size_t v = 0; v < stored_.size(); ++v) {
    if (stored_[v]) {
      grids.push_back(stored_[v]->grid());
      errors_.add(stored_[v]->errors());
      any = any || !lattices_[v].active.empty();
    } else {
      const Field<D>& field = scene_.volumes[v].volume().field;
      grids.emplace_back().lattice = inactive_lattice<D>(field.dims, shown_[v]);
    }
  }
  // If isosurfaces store no light, only the walls have noise.
  if (!any && walls_) walls_->add_noise(scene_.settings.exposure, errors_, scene_.progress);
  return grids;
}

template class RayBake<2>;
template class RayBake<3>;

}  // namespace leaflight
