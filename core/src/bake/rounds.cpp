// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/rounds.h"

#include <chrono>
#include <cmath>

#include "leaflight/bake/direct_light.h"
#include "leaflight/bake/indirect_light.h"
#include "leaflight/bake/light_surroundings.h"
#include "leaflight/bake/photon_caches.h"
#include "leaflight/bake/pooled_variance.h"
#include "leaflight/math/error.h"
#include "leaflight/math/sampling.h"
#include "leaflight/transport/placement.h"

namespace leaflight {
namespace {

// Texels that a bake has by default, at most, where they are finer than voxels.
constexpr std::size_t most_finer_texels = 2'500'000;
constexpr int most_halvings = 2;
// Where there are more texels than this, soft light's lines are two texels apart, or its texels
// coarser, or those that photons fall into.
constexpr std::size_t most_dense_texels = 200'000, most_soft_texels = 20'000'000,
                      most_photon_texels = 300'000;
constexpr int widest_texel = 8;
// A first picture has texels so many voxels wide, and is made where the bake has more than so many.
constexpr int preview_width = 4;
constexpr std::size_t most_without_preview = 200'000;
// Photons tell of the light that has bounced more than once before the sweeps know it, and of the
// soft light of the surroundings.
constexpr std::uint64_t photons = 400'000, preview_photons = 20'000;
constexpr int wall_samples = 2;
constexpr int bounces = 3, bounce_directions = 16;
// Blocks of sweeps of the first round; at least so many in the end, since their differences tell
// the error; and at most.
constexpr int first_blocks = 2, least_blocks = 4, most_blocks = 32;
// The noise's part of the error that is asked for: the rest is the texture's.
constexpr double noise_share = 0.5;
constexpr int surroundings_samples = 16;

template <int D>
Index<D> resolution_of(const Field<D>& field, double voxels_per_texel) {
  Index<D> resolution;
  for (int a = 0; a < D; ++a) {
    resolution[a] =
        std::max(2, static_cast<int>(std::ceil((field.dims[a] - 1) / voxels_per_texel)) + 1);
  }
  return resolution;
}

// One bake, from nothing to any number of blocks.
template <int D>
class SweptBake {
 public:
  SweptBake(const SweptVolume<D>& volume, const LightSampler<D>& lights,
            const BakeSettings<D>& settings, const Plan& plan, Progress& progress,
            std::atomic<std::uint64_t>& rays, SweptLattice<D> texels, SweptLattice<D> soft_texels,
            int spacing, const TexelLattice<D>& photon_texels, std::uint64_t photon_count)
      : volume_(volume),
        lights_(lights),
        settings_(settings),
        plan_(plan),
        progress_(progress),
        rays_(rays),
        texels_(std::move(texels)),
        direct_(volume, lights, texels_, plan.back, settings.seed) {
    if (plan.indirect) {
      indirect_ = std::make_unique<IndirectLight<D>>(volume, std::move(soft_texels), spacing,
                                                     plan.back, settings.seed);
      trace_photons(photon_texels, photon_count);
    }
  }

  void add(int direct_blocks, int indirect_blocks) {
    progress_.begin("Direct light");
    for (int i = 0; i < direct_blocks; ++i) direct_.add_block(progress_, rays_);
    if (!indirect_) return;
    progress_.begin("Indirect light");
    learn_inner_direct();
    if (indirect_->blocks() == 0) {
      for (int i = 0; i < bounces; ++i) {
        indirect_->add_block(gathered(), progress_, rays_, bounce_directions);
        learn_soft();
        indirect_->clear();
      }
    }
    for (int i = 0; i < indirect_blocks; ++i) indirect_->add_block(gathered(), progress_, rays_);
    learn_soft();
  }

  int direct_blocks() const { return direct_.blocks(); }
  int indirect_blocks() const { return indirect_ ? indirect_->blocks() : 0; }
  double direct_cost() const { return direct_.cost(); }
  double indirect_cost() const { return indirect_ ? indirect_->cost() : 0; }
  // Mean squares over the texels of the standard errors of colours, as publish() found them.
  double direct_noise() const { return direct_noise_; }
  double indirect_noise() const { return indirect_noise_; }

  RadianceGrid<D> publish() {
    progress_.begin("Radiance of the texels");
    SideAverages direct, indirect;
    const int sides = plan_.back ? 2 : 1;
    for (int side = 0; side < sides; ++side) {
      direct[side] = direct_.averages(side != 0);
      indirect[side].resize(direct[side].size());
      if (indirect_) {
        const TexelLattice<D>& soft = indirect_->texels().lattice;
        std::vector<Average> averages = indirect_->averages(side != 0);
        pool_variances(soft, averages, progress_);
        indirect[side] = interpolated(soft, averages, texels_.lattice, progress_);
      }
      finish(direct[side], indirect[side]);
    }
    measure_noise(direct[0], indirect[0]);
    RadianceGrid<D> grid = make_grid<D>(direct, indirect);
    grid.lattice = texels_.lattice;
    return grid;
  }

  SurroundingsRadiance<D> light_meshes() {
    progress_.begin("Radiance of the surroundings");
    std::vector<LeafRadiance<D>> leaves(1);
    std::unique_ptr<IndirectEstimator<D>> estimator;
    if (indirect_) {
      const TexelLattice<D>& lattice = indirect_->texels().lattice;
      leaves[0].lattice = &lattice;
      leaves[0].photons = photons_.leaves[0].get();
      for (int side = 0; side < 2; ++side) {
        std::vector<Rgb>& all = leaves[0].radiance[side];
        all.assign(lattice.active.size(), Rgb(0));
        if (side == 0 || plan_.back) {
          const auto direct =
              interpolated(texels_.lattice, direct_.averages(side != 0), lattice, progress_);
          for (std::size_t s = 0; s < all.size(); ++s) all[s] = direct[s].mean;
        }
        for (std::size_t s = 0; s < soft_[side].size(); ++s) {
          all[s] +=
              soft_[side][s] * albedo_near(volume_.volume(), lattice.centre(lattice.active[s]));
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

 private:
  void trace_photons(const TexelLattice<D>& texels, std::uint64_t count) {
    BakeSettings<D> settings = settings_;
    settings.photons = count;
    lattices_ = {texels};
    photons_ = trace_into_caches(volume_.tracer, lights_, lattices_, settings, plan_, wall_samples,
                                 progress_, rays_);
    const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
    for (int side = 0; side < 2; ++side) {
      std::vector<Average> known(texels.active.size());
      for (std::size_t s = 0; s < known.size(); ++s) {
        known[s].mean =
            photons_.leaves[0]->irradiance(static_cast<std::int32_t>(s), side != 0) * brdf;
      }
      known = interpolated(texels, known, indirect_->texels().lattice, progress_);
      soft_[side].resize(known.size());
      for (std::size_t s = 0; s < known.size(); ++s) soft_[side][s] = known[s].mean;
    }
  }

  // What the sweeps know better than the photons did.
  void learn_soft() {
    for (int side = 0; side < (plan_.back ? 2 : 1); ++side) {
      const std::vector<Average> averages = indirect_->averages(side != 0);
      for (std::size_t s = 0; s < averages.size(); ++s) soft_[side][s] = averages[s].mean;
    }
  }
  void learn_inner_direct() {
    if (!plan_.back) return;
    const std::vector<Average> averages = interpolated(texels_.lattice, direct_.averages(true),
                                                       indirect_->texels().lattice, progress_);
    inner_direct_.clear();
    for (const Average& average : averages) inner_direct_.push_back(average.mean);
  }

  GatheredRadiance<D> gathered() const {
    return {indirect_->texels(),
            {&soft_[0], &soft_[1]},
            &inner_direct_,
            direct_.shadows(),
            photons_.surroundings.get()};
  }

  // From white leaves to those of the scene, and from blocks' variances to standard errors.
  void finish(std::vector<Average>& direct, std::vector<Average>& indirect) {
    pool_variances(texels_.lattice, direct, progress_);
    const Volume<D>& of = volume_.volume();
    const IsovalueWindow& window = volume_.tracer.scene().window;
    const bool emissive = of.emission.largest() > 0;
    for (std::size_t s = 0; s < direct.size(); ++s) {
      const Vec<D> centre = texels_.lattice.centre(texels_.lattice.active[s]);
      const Rgb albedo = albedo_near(of, centre);
      indirect[s].mean *= albedo;
      const auto scale = static_cast<float>(average(albedo));
      indirect[s].variance *= scale * scale;
      if (!emissive) continue;
      const CellPoint<D> at = locate(of.field, centre);
      const double h = interpolate(load_corners(of.field, at.cell), at.local);
      const double c = std::isnan(h) ? window.min : of.leaf_coordinate(h);
      indirect[s].mean += of.emission.at(std::clamp(c, window.min, window.max));
    }
  }

  // At points of the leaves, as many for an area of leaves wherever it is.
  void measure_noise(const std::vector<Average>& direct, const std::vector<Average>& indirect) {
    constexpr std::size_t most_points = 1 << 16;
    const TexelLattice<D>& lattice = texels_.lattice;
    const Volume<D>& of = volume_.volume();
    const std::size_t step = 1 + lattice.active.size() / most_points;
    double sum = 0, sum_direct = 0, sum_indirect = 0;
    for (std::size_t s = 0; s < direct.size(); s += step) {
      Random random = random_for(settings_.seed, Purpose::noise, s);
      Vec<D> position = lattice.centre(lattice.active[s]);
      for (int a = 0; a < D; ++a) {
        position[a] += (random.uniform() - 0.5) * lattice.voxels_per_texel[a];
      }
      const CellPoint<D> at = locate(of.field, position);
      if (!volume_.window().contains(interpolate(load_corners(of.field, at.cell), at.local))) {
        continue;
      }
      const double area = shading_gradient(of.field, at).length();
      sum += area;
      const TexelWeights<D> near = linear_weights(lattice, position);
      double colour = 0, own = 0, soft = 0;
      for (int i = 0; i < (1 << D); ++i) {
        const double w = near.weight[i];
        if (!(w > 0)) continue;
        const Average &d = direct[near.slot[i]], &m = indirect[near.slot[i]];
        colour += w * average(d.mean + m.mean);
        own += w * w * d.variance;
        soft += w * w * m.variance;
      }
      // What is beyond white does not count.
      if (colour * settings_.exposure > 1) continue;
      sum_direct += area * own;
      sum_indirect += area * soft;
    }
    const double scale = sum > 0 ? settings_.exposure * settings_.exposure / sum : 0;
    direct_noise_ = sum_direct * scale;
    indirect_noise_ = sum_indirect * scale;
  }

  SweptVolume<D> volume_;
  const LightSampler<D>& lights_;
  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  std::atomic<std::uint64_t>& rays_;
  SweptLattice<D> texels_;
  DirectLight<D> direct_;
  std::unique_ptr<IndirectLight<D>> indirect_;  // null: nothing reflects
  std::vector<TexelLattice<D>> lattices_;       // of the photons
  PhotonCaches<D> photons_;
  std::array<std::vector<Rgb>, 2> soft_;
  std::vector<Rgb> inner_direct_;
  double direct_noise_ = 0, indirect_noise_ = 0;
};

// The texels of a bake: as fine as the settings say, or as voxels, or finer where they are few.
template <int D>
TexelLattice<D> texels_of(const SweptVolume<D>& volume, const BakeSettings<D>& settings) {
  const Field<D>& field = volume.volume().field;
  const IsovalueWindow window = volume.window();
  const bool chosen = settings.resolution != Index<D>{};
  TexelLattice<D> lattice =
      make_lattice(field, chosen ? settings.resolution : field.dims, window.min, window.max);
  if (chosen) return lattice;
  for (int i = 0; i < most_halvings; ++i) {
    if (lattice.active.size() << D > most_finer_texels) break;
    Index<D> finer;
    for (int a = 0; a < D; ++a) finer[a] = 2 * lattice.resolution[a] - 1;
    lattice = make_lattice(field, finer, window.min, window.max);
  }
  return lattice;
}

// A lattice with texels of so many voxels.
template <int D>
TexelLattice<D> lattice_of(const SweptVolume<D>& volume, double voxels_per_texel) {
  const IsovalueWindow window = volume.window();
  const Field<D>& field = volume.volume().field;
  return make_lattice(field, resolution_of(field, voxels_per_texel), window.min, window.max);
}

// How many voxels wide texels are for there to be at most so many.
int width_for(std::size_t voxels, std::size_t most, int dimension) {
  int width = 1;
  while (width < widest_texel && voxels > most) {
    width *= 2;
    voxels >>= dimension;
  }
  return width;
}

}  // namespace

template <int D>
bool fits_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan) {
  return settings.samples == 0 && settings.estimator == EstimatorName::gather &&
         !settings.scattered && settings.only_at.empty() && scene.volumes.size() == 1 &&
         scene.volumes[0].scattering == Scattering::diffuse && !plan.specular;
}

template <int D>
Baked<D> bake_in_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const OnRound<D>& on_round) {
  const auto start = std::chrono::steady_clock::now();
  const SceneTracer<D> tracer(scene);
  check_placement(tracer);
  const LightSampler<D> lights(tracer);
  std::atomic<std::uint64_t> rays{0};
  const std::vector<Vec<D, float>> gradients =
      voxel_gradients(scene.volumes[0].field, inverse(tracer.index_to_frame(0)));
  const SweptVolume<D> volume{tracer, 0, gradients};
  SweptLattice<D> texels(texels_of(volume, settings));
  if (texels.lattice.active.empty()) {
    throw Error(
        "No isosurface of the isovalue window passes through the volume; widen the window.");
  }
  int rounds = 0;
  const auto ended = [&] {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return progress.stopped() || (settings.seconds > 0 && seconds > settings.seconds);
  };
  const auto whole = [&](SweptBake<D>& bake, bool meshes) {
    Baked<D> baked;
    baked.grids.push_back(bake.publish());
    if (meshes && plan.surroundings) baked.surroundings = bake.light_meshes();
    baked.statistics.rays = rays;
    baked.statistics.rounds = ++rounds;
    baked.statistics.noise_percent = 100 * std::sqrt(bake.direct_noise() + bake.indirect_noise());
    return baked;
  };

  const std::size_t count = texels.lattice.active.size();
  if (on_round && count > most_without_preview) {
    const SweptLattice<D> coarse(lattice_of(volume, preview_width));
    SweptBake<D> preview(volume, lights, settings, plan, progress, rays, coarse, coarse, 1,
                         coarse.lattice, preview_photons);
    preview.add(first_blocks, first_blocks);
    on_round(whole(preview, false));
  }

  // Those of soft light are not finer than voxels.
  const TexelLattice<D> voxels = lattice_of(volume, 1);
  const std::size_t passed = voxels.active.size();
  const int soft_width = width_for(passed, most_soft_texels, D);
  const int photon_width = width_for(passed, most_photon_texels, D);
  SweptLattice<D> soft(soft_width == 1 ? voxels : lattice_of(volume, soft_width));
  const TexelLattice<D> photon_texels = lattice_of(volume, photon_width);
  const int spacing = passed > most_dense_texels ? 2 : 1;
  SweptBake<D> bake(volume, lights, settings, plan, progress, rays, std::move(texels),
                    std::move(soft), spacing, photon_texels, photons);
  int direct = first_blocks, indirect = plan.indirect ? first_blocks : 0;
  const double target = std::pow(noise_share * settings.error / 100, 2);
  for (;;) {
    progress.expect(bake.direct_cost() * std::max(direct, least_blocks) +
                    bake.indirect_cost() * (bounces + std::max(indirect, least_blocks)));
    bake.add(direct - bake.direct_blocks(), indirect - bake.indirect_blocks());
    const bool enough = std::min(direct, plan.indirect ? indirect : direct) >= least_blocks;
    if (enough && direct + indirect >= 2 * most_blocks) break;
    Baked<D> baked = whole(bake, false);
    // Blocks for which cost is least that leave the noise asked for.
    const double own = bake.direct_noise() * direct, other = bake.indirect_noise() * indirect;
    const double own_cost = bake.direct_cost(), other_cost = std::max(1.0, bake.indirect_cost());
    if (enough && own / direct + (indirect ? other / indirect : 0) <= target) break;
    if (ended()) break;
    const double both = (std::sqrt(own * own_cost) + std::sqrt(other * other_cost)) / target;
    const auto next = [&](int now, double variance, double cost) {
      const double wanted = std::sqrt(variance / cost) * both;
      return static_cast<int>(std::clamp(
          std::ceil(wanted), static_cast<double>(std::max(now, std::min(least_blocks, 2 * now))),
          static_cast<double>(std::min(2 * now, most_blocks))));
    };
    direct = next(direct, own, own_cost);
    if (plan.indirect) indirect = next(indirect, other, other_cost);
    if (on_round) on_round(std::move(baked));
    if (ended()) break;
  }
  Baked<D> baked = whole(bake, true);
  baked.statistics.stopped = ended();
  return baked;
}

template bool fits_rounds<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&);
template bool fits_rounds<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&);
template Baked<2> bake_in_rounds<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&,
                                    const OnRound<2>&);
template Baked<3> bake_in_rounds<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&,
                                    const OnRound<3>&);

}  // namespace leaflight
