// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/fixed_samples.h"

#include <cmath>

#include "leaflight/bake/leaf_averages.h"
#include "leaflight/bake/light_surroundings.h"
#include "leaflight/bake/photon_caches.h"
#include "leaflight/bake/point_sampler.h"
#include "leaflight/bake/refinement.h"
#include "leaflight/math/error.h"
#include "leaflight/math/parallel.h"
#include "leaflight/math/sampling.h"
#include "leaflight/transport/placement.h"
#include "leaflight/transport/thesis_estimator.h"

namespace leaflight {
namespace {

// Progress is counted in rays; photons bounce a few times, paths more often.
constexpr int wall_samples = 8;
constexpr double rays_per_gather = 1, rays_per_path = 6;

template <int D>
class Baker {
 public:
  Baker(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
        Progress& progress)
      : settings_(settings), plan_(plan), progress_(progress), tracer_(scene), lights_(tracer_) {
    check_placement(tracer_);
    for (const Volume<D>& volume : scene.volumes) {
      // What a mirror or glass shows depends on the view, so that no texel can hold it.
      const bool stored = volume.scattering == Scattering::diffuse;
      lattices_.push_back(lattice_of(volume, stored));
      if (settings.scattered) positions_.push_back(strewn(volume, stored));
    }
  }

  Baked<D> run() {
    check_anything_to_bake();
    expect_work();
    const bool thesis = settings_.estimator == EstimatorName::thesis;
    if (plan_.photons && thesis) {
      progress_.begin("Tracing photons");
      std::uint64_t rays = 0;
      const auto photons =
          collect_photons(tracer_, lights_, settings_.seed, settings_.photons, progress_, rays);
      maps_ = make_photon_maps(tracer_, photons, settings_.photon_map);
      rays_ += rays;
    }
    if (thesis ? plan_.surroundings_cache : plan_.photons || plan_.caustics) {
      photons_ = trace_into_caches(tracer_, lights_, lattices_, settings_, plan_, wall_samples,
                                   progress_, rays_);
    }
    const std::size_t n = lattices_.size();
    leaves_.resize(n);
    std::vector<SideAverages> direct(n);
    for (int side = 0; side < sides(); ++side) {
      progress_.begin(side == 0 ? "Direct light" : "Direct light of the inner side");
      for (std::size_t v = 0; v < n; ++v) {
        direct[v][side] = direct_pass(v, side != 0, lattices_[v], 0);
      }
    }
    for (std::size_t v = 0; v < n; ++v) {
      leaves_[v].lattice = &lattices_[v];
      leaves_[v].photons = photons_.leaves.empty() ? nullptr : photons_.leaves[v].get();
      for (int side = 0; side < sides(); ++side) {
        for (const Average& a : direct[v][side]) leaves_[v].direct[side].push_back(a.mean);
      }
    }
    const std::unique_ptr<IndirectEstimator<D>> estimator = make_estimator();
    Baked<D> baked;
    for (std::size_t v = 0; v < n; ++v) {
      SideAverages indirect;
      for (int side = 0; side < sides(); ++side) {
        progress_.begin(side == 0 ? "Indirect light" : "Indirect light of the inner side");
        indirect[side] = indirect_pass(v, side != 0, estimator.get(), lattices_[v], 0);
      }
      baked.grids.push_back(make_grid<D>(direct[v], indirect));
      direct[v] = {};
    }
    if (settings_.refine > 0) {
      progress_.begin("Finer texels");
      for (std::size_t v = 0; v < n; ++v) add_finer_texels(v, baked.grids[v], estimator.get());
    }
    if (plan_.surroundings) {
      progress_.begin("Radiance of the surroundings");
      SurroundingsWork<D> work{std::move(fine_), surroundings_share * settings_.samples,
                               1 + indirect_work(), settings_.seed};
      baked.surroundings = light_surroundings(tracer_, sampler(), estimator.get(), std::move(work),
                                              progress_, rays_);
    }
    for (std::size_t v = 0; v < n; ++v) baked.grids[v].lattice = std::move(lattices_[v]);
    baked.statistics.rays = rays_;
    baked.statistics.skipped = plan_.skipped;
    return baked;
  }

 private:
  const Scene<D>& scene() const { return tracer_.scene(); }
  int sides() const { return plan_.back ? 2 : 1; }
  const SurfaceCache<D>* cache() const { return photons_.surroundings.get(); }
  bool gathers() const { return settings_.estimator == EstimatorName::gather; }

  TexelLattice<D> lattice_of(const Volume<D>& volume, bool stored) const {
    const Field<D>& field = volume.field;
    const Index<D> resolution =
        settings_.resolution == Index<D>{} ? field.dims : settings_.resolution;
    if (!stored) return inactive_lattice<D>(field.dims, resolution);
    const IsovalueWindow window = volume.isovalues(scene().window);
    if (settings_.only_at.empty()) {
      return make_lattice(field, resolution, window.min, window.max);
    }
    std::vector<Vec<D>> positions;
    for (const Vec<D>& point : settings_.only_at) {
      positions.push_back(field.world_to_index.point(point));
    }
    const std::vector<bool> considered = texels_around<D>(field.dims, resolution, positions);
    return make_lattice(field, resolution, window.min, window.max, &considered);
  }

  std::vector<Vec<D>> strewn(const Volume<D>& volume, bool stored) const {
    if (!stored) return {};
    SampleSettings samples = settings_.scattered->samples;
    samples.seed = settings_.seed;
    return sample_positions(volume.field, volume.isovalues(scene().window), samples);
  }

  void check_anything_to_bake() const {
    std::size_t texels = 0;
    for (const TexelLattice<D>& lattice : lattices_) texels += lattice.active.size();
    if (texels > 0 || plan_.surroundings) return;
    for (const Volume<D>& volume : scene().volumes) {
      if (volume.scattering != Scattering::diffuse) {
        throw Error("What the isosurfaces of the volume '" + volume.name +
                    "' show depends on the view, since they are " +
                    (volume.scattering == Scattering::mirror ? "mirrors" : "glass") +
                    ", and nothing else is to be baked; bake the surroundings too.");
      }
    }
    throw Error(
        "No isosurface of the isovalue window passes through the volume; widen the window.");
  }

  double indirect_work() const {
    if (!plan_.indirect) return 0;
    if (settings_.estimator == EstimatorName::path) return rays_per_path;
    return gathers() ? rays_per_gather : 0;
  }

  void expect_work() {
    double points = 0;
    for (std::size_t v = 0; v < lattices_.size(); ++v) {
      points += sides() * static_cast<double>(sample_places(v));
    }
    // About as many finer texels are sampled as there are others.
    points *= 1 + settings_.refine;
    if (plan_.surroundings) {
      fine_ = refine(scene().meshes);
      for (const FineMesh<D>& mesh : fine_) {
        points += 1.0 * surroundings_share * LeafNodes::count * mesh.vertices.size();
      }
    }
    const double photons =
        (plan_.photons ? settings_.photons : 0) + (plan_.caustics ? settings_.caustic_photons : 0);
    progress_.expect(rays_per_photon * photons +
                     points * settings_.samples * (1 + indirect_work()));
  }

  // Texels, or scattered samples, of a volume.
  std::size_t sample_places(std::size_t volume) const {
    return settings_.scattered ? positions_[volume].size() : lattices_[volume].active.size();
  }

  std::unique_ptr<IndirectEstimator<D>> make_estimator() const {
    if (!plan_.indirect) return nullptr;
    switch (settings_.estimator) {
      case EstimatorName::path:
        return make_path_estimator(tracer_, lights_);
      case EstimatorName::volumetric:
        return make_volumetric_estimator(leaves_, cache());
      case EstimatorName::thesis:
        return make_thesis_estimator(maps_, cache());
      default:
        return make_gather_estimator(tracer_, lights_, leaves_, *cache());
    }
  }

  PointSampler<D> sampler() const { return {lights_, leaves_, cache(), plan_.caustics}; }

  // Averages radiance(point, keys, i, rays) over the texels of a volume, or over its scattered
  // samples; where it is not random, one estimate at each of those is enough.
  template <class Radiance>
  std::vector<Average> over_texels(std::size_t volume, const TexelLattice<D>& lattice,
                                   LeafSamples samples, bool is_random, Radiance radiance) {
    if (!settings_.scattered || lattice.active.empty()) {
      return average_texels(tracer_, lattice, samples, progress_, rays_, radiance);
    }
    if (!is_random) samples.count = 1;
    return average_scattered(tracer_, lattice, samples, positions_[volume],
                             settings_.scattered->filter, progress_, rays_, radiance);
  }

  // Those of a texel, in a lattice whose texels were halved `level` times.
  LeafSamples leaf_samples(std::size_t volume, bool above, double rays_per_sample,
                           int level) const {
    return {static_cast<int>(volume), above,          settings_.samples,
            rays_per_sample,          settings_.seed, level};
  }

  std::vector<Average> direct_pass(std::size_t volume, bool above, const TexelLattice<D>& lattice,
                                   int level) {
    const PointSampler<D> from = sampler();
    return over_texels(volume, lattice, leaf_samples(volume, above, 1, level), true,
                       [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i,
                           std::uint64_t& rays) { return from.direct(point, keys, i, rays); });
  }

  std::vector<Average> indirect_pass(std::size_t volume, bool above,
                                     const IndirectEstimator<D>* estimator,
                                     const TexelLattice<D>& lattice, int level) {
    // Where light varies, records of a coarser lattice would not do.
    const bool records =
        estimator && settings_.soft_spacing > 1 && !settings_.scattered && level == 0;
    const IndirectEstimator<D>* per_texel = records ? nullptr : estimator;
    const PointSampler<D> from = sampler();
    std::vector<Average> averages(lattice.active.size());
    if (per_texel || plan_.caustics || scene().volumes[volume].emission.largest() > 0) {
      averages = over_texels(
          volume, lattice, leaf_samples(volume, above, per_texel ? indirect_work() : 0, level),
          per_texel && per_texel->is_random(),
          [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i, std::uint64_t& rays) {
            return from.indirect(point, per_texel, keys, i, rays);
          });
    }
    add_photon_noise(averages, volume, above, estimator, lattice);
    if (!records) return averages;
    const std::vector<Average> soft = soft_from_records(volume, above, *estimator);
    for (std::size_t s = 0; s < soft.size(); ++s) {
      averages[s].mean += soft[s].mean;
      averages[s].variance += soft[s].variance;
    }
    return averages;
  }

  // What all samples of a texel have in common, and so do not show: the noise of the photons'
  // density. Final gather rays look it up at so many places that it averages out.
  void add_photon_noise(std::vector<Average>& averages, std::size_t volume, bool above,
                        const IndirectEstimator<D>* estimator,
                        const TexelLattice<D>& lattice) const {
    const bool volumetric = estimator && settings_.estimator == EstimatorName::volumetric;
    const bool thesis = estimator && settings_.estimator == EstimatorName::thesis;
    const LeafCache<D>* photons = leaves_[volume].photons;
    for (std::size_t s = 0; s < averages.size(); ++s) {
      if (thesis) {
        const double mean = average(averages[s].mean);
        averages[s].variance += static_cast<float>(mean * mean / settings_.photon_map.k);
      }
      if (!photons || !(volumetric || plan_.caustics)) continue;
      const Vec<D> centre = lattice.centre(lattice.active[s]);
      const std::int32_t slot = lattices_[volume].nearest_slot(centre);
      if (slot == TexelLattice<D>::inactive) continue;
      const auto brdf = static_cast<float>(average(albedo_near(scene().volumes[volume], centre)) /
                                           projected_hemisphere<D>);
      float variance = 0;
      if (volumetric) variance += photons->soft_variance(slot, above);
      if (plan_.caustics) variance += photons->caustic_variance(slot, above);
      averages[s].variance += brdf * brdf * variance;
    }
  }

  // Soft light gathered at the points of a coarser lattice, as for a white leaf, and interpolated.
  // A record serves spacing^D texels, and so affords spacing^2 times the samples of one.
  std::vector<Average> soft_from_records(std::size_t volume, bool above,
                                         const IndirectEstimator<D>& estimator) {
    const TexelLattice<D>& lattice = lattices_[volume];
    const Volume<D>& of = scene().volumes[volume];
    const int spacing = settings_.soft_spacing;
    Index<D> resolution;
    for (int a = 0; a < D; ++a) {
      resolution[a] = std::max(2, (lattice.resolution[a] - 1 + spacing - 1) / spacing + 1);
    }
    const IsovalueWindow window = of.isovalues(scene().window);
    const TexelLattice<D> coarse = make_lattice(of.field, resolution, window.min, window.max);
    const PointSampler<D> from = sampler();
    LeafSamples samples = leaf_samples(volume, above, indirect_work(), 0);
    samples.count *= spacing * spacing;
    const std::vector<Average> records = average_texels(
        tracer_, coarse, samples, progress_, rays_,
        [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i, std::uint64_t& rays) {
          SurfacePoint<D> white = point;
          white.albedo = Rgb(1);
          return from.soft(white, estimator, keys, i, rays);
        });
    std::vector<Average> soft(lattice.active.size());
    parallel_range(soft.size(), 1024, 0, progress_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const Vec<D> centre = lattice.centre(lattice.active[s]);
        const TexelWeights<D> weights = linear_weights(coarse, centre);
        for (int i = 0; i < (1 << D); ++i) {
          if (!(weights.weight[i] > 0)) continue;
          const Average& record = records[weights.slot[i]];
          soft[s].mean += record.mean * weights.weight[i];
          soft[s].variance += record.variance * weights.weight[i] * weights.weight[i];
        }
        const Rgb albedo = albedo_near(of, centre);
        soft[s].mean *= albedo;
        soft[s].variance *= static_cast<float>(average(albedo) * average(albedo));
      }
    });
    return soft;
  }

  // Texels of half the width, again and again, where light varies most.
  void add_finer_texels(std::size_t volume, RadianceGrid<D>& grid,
                        const IndirectEstimator<D>* estimator) {
    const Volume<D>& of = scene().volumes[volume];
    const IsovalueWindow window = of.isovalues(scene().window);
    grid.lattice = lattices_[volume];
    RadianceGrid<D>* finest = &grid;
    for (int level = 1; level <= settings_.refine; ++level) {
      const auto cells = cells_to_refine(of.field, window, grid, settings_.exposure);
      FinerTexels<D> texels = finer_texels(of.field, window, grid, cells);
      if (texels.all.active.empty()) return;
      SideAverages direct, indirect;
      for (int side = 0; side < sides(); ++side) {
        direct[side] = direct_pass(volume, side != 0, texels.sampled, level);
        indirect[side] = indirect_pass(volume, side != 0, estimator, texels.sampled, level);
      }
      const RadianceGrid<D> sampled = make_grid<D>(direct, indirect);
      finest->finer =
          std::make_shared<RadianceGrid<D>>(finer_grid(grid, std::move(texels), sampled));
      finest = finest->finer.get();
    }
  }

  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  SceneTracer<D> tracer_;
  LightSampler<D> lights_;
  std::vector<TexelLattice<D>> lattices_;  // per volume
  PhotonCaches<D> photons_;
  std::vector<LeafRadiance<D>> leaves_;         // per volume
  std::vector<PhotonMap<D>> maps_;              // per volume
  std::vector<std::vector<Vec<D>>> positions_;  // of scattered samples, per volume
  std::vector<FineMesh<D>> fine_;
  std::atomic<std::uint64_t> rays_{0};
};

}  // namespace

template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const BakeSettings<D>& settings,
                                 const Plan& plan, Progress& progress) {
  return Baker<D>(scene, settings, plan, progress).run();
}

template Baked<2> bake_with_fixed_samples<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&,
                                             Progress&);
template Baked<3> bake_with_fixed_samples<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&,
                                             Progress&);

}  // namespace leaflight
