// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/bake.h"

#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "leaflight/bake/texel_samples.h"
#include "leaflight/math/error.h"
#include "leaflight/math/parallel.h"
#include "leaflight/transport/placement.h"
#include "leaflight/transport/thesis_estimator.h"

namespace leaflight {
namespace {

constexpr std::size_t photons_per_piece = 4096;
constexpr std::size_t texels_per_piece = 64;
constexpr int surroundings_samples = 8;
// Vertices of the surroundings are fewer and farther apart than texels, and take more samples.
constexpr int surroundings_share = 2;
// A side of the surroundings is tried at every so many vertices before it is lit.
constexpr std::size_t probe_stride = 16;
// Progress is counted in rays; photons bounce a few times, paths more often.
constexpr double rays_per_photon = 3, rays_per_gather = 1, rays_per_path = 6;

std::uint64_t peak_memory() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Mean of samples and the variance of that mean.
struct Average {
  Rgb mean{0};
  float variance = 0;
};

class Moments {
 public:
  void add(const Rgb& sample, double weight) {
    const double m = average(sample), weight2 = weight * weight;
    weight_ += weight;
    sum_ += Imath::V3d(sample) * weight;
    weight2_ += weight2;
    mean2_ += weight2 * m;
    square2_ += weight2 * m * m;
  }
  Average average_of(int n) const {
    if (n == 0) return {};
    const Imath::V3d mean = sum_ / weight_;
    const double m = (mean.x + mean.y + mean.z) / 3;
    const double spread = square2_ - 2 * m * mean2_ + m * m * weight2_;
    const double variance = std::max(0.0, spread) / (weight_ * weight_);
    return {Rgb(mean), n > 1 ? static_cast<float>(variance * n / (n - 1)) : 0};
  }

 private:
  Imath::V3d sum_{0};
  double weight_ = 0, weight2_ = 0, mean2_ = 0, square2_ = 0;
};

template <int D>
class Baker {
 public:
  Baker(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
        Progress& progress)
      : settings_(settings), plan_(plan), progress_(progress), tracer_(scene), lights_(tracer_) {
    check_placement(tracer_);
    for (const Volume<D>& volume : scene.volumes) {
      const Index<D> resolution =
          settings.resolution == Index<D>{} ? volume.field.dims : settings.resolution;
      // What a mirror or glass shows depends on the view, so that no texel can hold it.
      const bool stored = volume.scattering == Scattering::diffuse;
      lattices_.push_back(stored ? make_lattice(volume.field, resolution,
                                                volume.isovalue(scene.window.min),
                                                volume.isovalue(scene.window.max))
                                 : inactive_lattice<D>(volume.field.dims, resolution));
      if (settings.scattered) positions_.push_back(strewn(volume, stored));
    }
  }

  Baked<D> run() {
    check_anything_to_bake();
    expect_work();
    const bool thesis = settings_.estimator == EstimatorName::thesis;
    if (plan_.photons && thesis) fill_photon_maps();
    if (thesis ? plan_.surroundings_cache : plan_.photons || plan_.caustics) {
      trace_photons_into_caches();
    }
    const std::size_t n = lattices_.size();
    leaves_.resize(n);
    std::array<std::vector<std::vector<Average>>, 2> direct;
    for (int side = 0; side < sides(); ++side) {
      progress_.begin(side == 0 ? "Direct light" : "Direct light of the inner side");
      for (std::size_t v = 0; v < n; ++v) direct[side].push_back(direct_pass(v, side != 0));
    }
    for (std::size_t v = 0; v < n; ++v) {
      leaves_[v].lattice = &lattices_[v];
      leaves_[v].photons = caches_.empty() ? nullptr : caches_[v].get();
      for (int side = 0; side < sides(); ++side) {
        for (const Average& a : direct[side][v]) leaves_[v].direct[side].push_back(a.mean);
      }
    }
    const std::unique_ptr<IndirectEstimator<D>> estimator = make_estimator();
    Baked<D> baked;
    for (std::size_t v = 0; v < n; ++v) {
      std::array<std::vector<Average>, 2> indirect;
      for (int side = 0; side < sides(); ++side) {
        progress_.begin(side == 0 ? "Indirect light" : "Indirect light of the inner side");
        indirect[side] = indirect_pass(v, side != 0, estimator.get());
      }
      baked.grids.push_back(assemble(v, direct, indirect));
    }
    if (plan_.surroundings) baked.surroundings = surroundings_pass(estimator.get());
    for (std::size_t v = 0; v < n; ++v) baked.grids[v].lattice = std::move(lattices_[v]);
    baked.statistics.rays = rays_;
    baked.statistics.skipped = plan_.skipped;
    return baked;
  }

 private:
  const Scene<D>& scene() const { return tracer_.scene(); }
  int sides() const { return plan_.back ? 2 : 1; }
  const SurfaceCache<D>* cache() const { return surroundings_ ? &*surroundings_ : nullptr; }
  bool gathers() const { return settings_.estimator == EstimatorName::gather; }

  std::vector<Vec<D>> strewn(const Volume<D>& volume, bool stored) const {
    if (!stored) return {};
    SampleSettings samples = settings_.scattered->samples;
    samples.seed = settings_.seed;
    const IsovalueWindow& window = scene().window;
    return sample_positions(volume.field,
                            {volume.isovalue(window.min), volume.isovalue(window.max)}, samples);
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

  void fill_photon_maps() {
    progress_.begin("Tracing photons");
    std::uint64_t rays = 0;
    const auto photons =
        collect_photons(tracer_, lights_, settings_.seed, settings_.photons, progress_, rays);
    maps_ = make_photon_maps(tracer_, photons, settings_.photon_map);
    rays_ += rays;
  }

  void trace_photons_into_caches() {
    // The largest flux-height with which any photon starts (thesis Eq. 4.4).
    std::uint64_t photons = plan_.photons ? settings_.photons : 0;
    std::uint64_t fewest = plan_.photons ? settings_.photons : settings_.caustic_photons;
    if (plan_.caustics) {
      photons += settings_.caustic_photons;
      fewest = std::min(fewest, settings_.caustic_photons);
    }
    const double photon_flux = lights_.largest_flux_height() / static_cast<double>(fewest);
    const SideContents inner = plan_.back         ? SideContents::indirect
                               : plan_.inner_side ? SideContents::all
                                                  : SideContents::nothing;
    for (std::size_t v = 0; v < lattices_.size(); ++v) {
      caches_.push_back(std::make_unique<LeafCache<D>>(
          tracer_, static_cast<int>(v), lattices_[v], inner, plan_.caustics, photon_flux, photons));
    }
    if (plan_.surroundings_cache || gathers()) {
      surroundings_.emplace(tracer_, plan_.caustics, photon_flux, photons);
    }
    if (plan_.photons) {
      progress_.begin("Tracing photons");
      trace(PhotonPaths::all, settings_.photons);
    }
    if (plan_.caustics) {
      progress_.begin("Tracing caustics");
      trace(PhotonPaths::caustics, settings_.caustic_photons);
    }
    for (const auto& cache : caches_) cache->finish(progress_);
    if (!plan_.surroundings_cache || !gathers()) return;
    progress_.begin("Lighting the surroundings");
    parallel_range(
        surroundings_->entries(), 256, 0, progress_, [&](std::size_t begin, std::size_t end) {
          std::uint64_t rays = 0;
          for (std::size_t e = begin; e < end; ++e) {
            surroundings_->finish(e, lights_, surroundings_samples, settings_.seed, rays);
          }
          rays_ += rays;
        });
  }

  void trace(PhotonPaths paths, std::uint64_t count) {
    parallel_range(count, photons_per_piece, rays_per_photon, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     rays_ +=
                         trace_photons(tracer_, lights_, paths, settings_.seed, begin, end, count,
                                       [&](const PhotonHit<D>& photon) {
                                         const bool caustic = photon.arrival == Arrival::caustic;
                                         // Caustic photons bring these.
                                         if (paths == PhotonPaths::all && plan_.caustics && caustic)
                                           return;
                                         store(photon);
                                       });
                   });
  }

  void store(const PhotonHit<D>& photon) {
    if (photon.point.kind == HitKind::leaf) {
      caches_[photon.point.volume]->deposit(photon);
    } else if (plan_.surroundings_cache) {
      surroundings_->deposit(photon);
    }
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
        return make_gather_estimator(tracer_, leaves_, *surroundings_);
    }
  }

  // Keys of a texel's low-discrepancy sequences; the position key is shared by all passes, so that
  // they see the same points.
  struct TexelKeys {
    std::uint64_t position, light, gather, paths;
  };
  TexelKeys keys(Purpose purpose, std::uint64_t volume, std::uint32_t texel) const {
    Random random = random_for(settings_.seed, purpose, volume << 32 | texel);
    return {random.bits(), random.bits(), random.bits(), random.bits()};
  }

  Rgb direct_sample(const SurfacePoint<D>& point, const TexelKeys& k, int i,
                    std::uint64_t& rays) const {
    const double choice = lights_.has_choice() ? sobol_point(i, ~k.light)[0] : 0;
    return lights_.direct_radiance(point, choice, sobol_point(i, k.light), rays);
  }

  // All but direct light.
  Rgb indirect_sample(const SurfacePoint<D>& point, const IndirectEstimator<D>* estimator,
                      const TexelKeys& k, int i, std::uint64_t& rays) const {
    Rgb radiance = point.emission;
    if (estimator) {
      Random random(k.paths, 0, i);
      radiance += estimator->indirect_radiance(point, sobol_point(i, k.gather), random, rays);
    }
    if (plan_.caustics) {
      radiance += caustic_radiance(leaves_, cache(), point);
    }
    return radiance;
  }

  // Averages radiance(point, keys, i, rays) over the samples of every active texel. The weight
  // |grad c| dV = dA dc makes it a mean over the area of the leaves, which is what a lookup on them
  // wants: steep places are surfaces, flat ones noise.
  template <class Radiance>
  std::vector<Average> over_texels(std::size_t volume, bool above, double work, bool is_random,
                                   Radiance radiance) {
    const TexelLattice<D>& lattice = lattices_[volume];
    if (settings_.scattered && !lattice.active.empty()) {
      return over_scattered(volume, above, work, is_random ? settings_.samples : 1, radiance);
    }
    return over_lattice(volume, above, lattice, settings_.samples, work, radiance);
  }

  template <class Radiance>
  std::vector<Average> over_lattice(std::size_t volume, bool above, const TexelLattice<D>& lattice,
                                    int samples, double work, Radiance radiance) {
    std::vector<Average> averages(lattice.active.size());
    parallel_range(averages.size(), texels_per_piece, work * samples, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     std::uint64_t rays = 0;
                     for (std::size_t s = begin; s < end && !progress_.cancelled(); ++s) {
                       const TexelKeys k = keys(Purpose::texel, volume, lattice.active[s]);
                       Moments moments;
                       const int n = for_each_texel_sample(
                           tracer_, static_cast<int>(volume), above, lattice, lattice.active[s],
                           samples, k.position, [&](const SurfacePoint<D>& point, int i) {
                             moments.add(radiance(point, k, i, rays), point.gradient_length);
                           });
                       averages[s] = moments.average_of(n);
                     }
                     rays_ += rays;
                   });
    return averages;
  }

  // The same for samples strewn over the domain: each is the mean of some estimates at its point,
  // of which one is enough where they do not differ.
  template <class Radiance>
  std::vector<Average> over_scattered(std::size_t volume, bool above, double work, int estimates,
                                      Radiance radiance) {
    const Volume<D>& of = scene().volumes[volume];
    const std::vector<Vec<D>>& positions = positions_[volume];
    std::vector<Rgb> values(positions.size(), Rgb(0));
    parallel_range(positions.size(), texels_per_piece, work * settings_.samples, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     std::uint64_t rays = 0;
                     for (std::size_t s = begin; s < end && !progress_.cancelled(); ++s) {
                       const CellPoint<D> at = locate(of.field, positions[s]);
                       const double h = interpolate(load_corners(of.field, at.cell), at.local);
                       const SurfacePoint<D> point = tracer_.leaf_point(
                           static_cast<int>(volume), at, of.leaf_coordinate(h), above);
                       if (point.kind == HitKind::none) continue;
                       const TexelKeys k =
                           keys(Purpose::scattered, volume, static_cast<std::uint32_t>(s));
                       Imath::V3d sum(0);
                       for (int i = 0; i < estimates; ++i) {
                         sum += Imath::V3d(radiance(point, k, i, rays));
                       }
                       values[s] = Rgb(sum / estimates);
                     }
                     rays_ += rays;
                   });
    const ScatteredTexels texels = interpolate_scattered(lattices_[volume], positions, values,
                                                         settings_.scattered->filter, progress_);
    std::vector<Average> averages;
    for (std::size_t s = 0; s < texels.value.size(); ++s) {
      averages.push_back({texels.value[s], texels.error[s] * texels.error[s]});
    }
    return averages;
  }

  std::vector<Average> direct_pass(std::size_t volume, bool above) {
    return over_texels(volume, above, 1, true,
                       [&](const SurfacePoint<D>& point, const TexelKeys& k, int i,
                           std::uint64_t& rays) { return direct_sample(point, k, i, rays); });
  }

  std::vector<Average> indirect_pass(std::size_t volume, bool above,
                                     const IndirectEstimator<D>* estimator) {
    const bool records = estimator && settings_.soft_spacing > 1 && !settings_.scattered;
    const IndirectEstimator<D>* per_texel = records ? nullptr : estimator;
    std::vector<Average> averages(lattices_[volume].active.size());
    if (per_texel || plan_.caustics || scene().volumes[volume].emission.largest() > 0) {
      averages = over_texels(
          volume, above, per_texel ? indirect_work() : 0, per_texel && per_texel->is_random(),
          [&](const SurfacePoint<D>& point, const TexelKeys& k, int i, std::uint64_t& rays) {
            return indirect_sample(point, per_texel, k, i, rays);
          });
    }
    if (!records) return averages;
    const std::vector<Average> soft = soft_from_records(volume, above, *estimator);
    for (std::size_t s = 0; s < soft.size(); ++s) {
      averages[s].mean += soft[s].mean;
      averages[s].variance += soft[s].variance;
    }
    return averages;
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
    const TexelLattice<D> coarse = make_lattice(
        of.field, resolution, of.isovalue(scene().window.min), of.isovalue(scene().window.max));
    const std::vector<Average> records = over_lattice(
        volume, above, coarse, settings_.samples * spacing * spacing, indirect_work(),
        [&](const SurfacePoint<D>& point, const TexelKeys& k, int i, std::uint64_t& rays) {
          SurfacePoint<D> white = point;
          white.albedo = Rgb(1);
          Random random(k.paths, 0, i);
          return estimator.indirect_radiance(white, sobol_point(i, k.gather), random, rays);
        });
    std::vector<Average> soft(lattice.active.size());
    parallel_range(soft.size(), 1024, 0, progress_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const Vec<D> centre =
            to_vector<D>(lattice.texel(lattice.active[s])) * lattice.voxels_per_texel;
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

  RadianceGrid<D> assemble(std::size_t volume,
                           const std::array<std::vector<std::vector<Average>>, 2>& direct,
                           const std::array<std::vector<Average>, 2>& indirect) const {
    RadianceGrid<D> grid;
    const std::vector<Average>& straight = direct[0][volume];
    const std::size_t n = straight.size();
    grid.radiance.resize(n);
    grid.radiance_indirect.resize(n);
    grid.radiance_error.resize(n);
    for (std::size_t s = 0; s < n; ++s) {
      grid.radiance[s] = Vec<3, float>(straight[s].mean + indirect[0][s].mean);
      grid.radiance_indirect[s] = Vec<3, float>(indirect[0][s].mean);
      grid.radiance_error[s] = std::sqrt(straight[s].variance + indirect[0][s].variance);
    }
    if (!plan_.back) return grid;
    for (std::size_t s = 0; s < n; ++s) {
      grid.radiance_back.emplace_back(direct[1][volume][s].mean + indirect[1][s].mean);
    }
    return grid;
  }

  SurroundingsRadiance<D> surroundings_pass(const IndirectEstimator<D>* estimator) {
    progress_.begin("Radiance of the surroundings");
    SurroundingsRadiance<D> result;
    result.nodes = LeafNodes(scene());
    result.meshes = std::move(fine_);
    result.radiance.resize(result.meshes.size());
    for (std::size_t m = 0; m < result.meshes.size(); ++m) {
      if (scene().meshes[m].scattering != Scattering::diffuse) continue;
      for (const bool back : {false, true}) {
        // A side that is dark at some of its points for all c is taken to be dark.
        if (dark(facets_radiance(result, m, back, probe_stride, estimator))) continue;
        result.radiance[m][back] = facets_radiance(result, m, back, 1, estimator);
      }
    }
    return result;
  }

  static bool dark(const std::vector<Vec<3, float>>& radiance) {
    return std::all_of(radiance.begin(), radiance.end(),
                       [](const auto& r) { return r == Vec<3, float>(0); });
  }

  // At every stride-th vertex of a mesh, for all nodes of c.
  std::vector<Vec<3, float>> facets_radiance(const SurroundingsRadiance<D>& result, std::size_t m,
                                             bool back, std::size_t stride,
                                             const IndirectEstimator<D>* estimator) {
    const std::vector<FacetPoint>& places = result.meshes[m].places;
    const std::size_t n = (places.size() + stride - 1) / stride, count = n * LeafNodes::count;
    std::vector<Vec<3, float>> radiance(count);
    const double work = surroundings_share * settings_.samples * (1 + indirect_work());
    parallel_range(
        count, texels_per_piece, work, progress_, [&](std::size_t begin, std::size_t end) {
          std::uint64_t rays = 0;
          for (std::size_t e = begin; e < end && !progress_.cancelled(); ++e) {
            const std::size_t vertex = e % n * stride;
            const FacetPoint& p = places[vertex];
            const SurfacePoint<D> point = tracer_.facet_point(
                p.mesh, p.facet, p.u, p.v, !back, result.nodes.node(static_cast<int>(e / n)));
            radiance[e] =
                Vec<3, float>(mean_radiance(point, 2 * m + back, vertex, estimator, rays));
          }
          rays_ += rays;
        });
    return radiance;
  }

  // All nodes of a vertex share their random numbers: what noise is left stands still while the
  // isovalue moves.
  Rgb mean_radiance(const SurfacePoint<D>& point, std::uint64_t surface, std::size_t vertex,
                    const IndirectEstimator<D>* estimator, std::uint64_t& rays) const {
    const TexelKeys k = keys(Purpose::surroundings, surface, static_cast<std::uint32_t>(vertex));
    const int samples = surroundings_share * settings_.samples;
    Imath::V3d sum(0);
    for (int i = 0; i < samples; ++i) {
      sum += Imath::V3d(direct_sample(point, k, i, rays)) +
             Imath::V3d(indirect_sample(point, estimator, k, i, rays));
    }
    return Rgb(sum / samples);
  }

  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  SceneTracer<D> tracer_;
  LightSampler<D> lights_;
  std::vector<TexelLattice<D>> lattices_;              // per volume
  std::vector<std::unique_ptr<LeafCache<D>>> caches_;  // per volume
  std::vector<LeafRadiance<D>> leaves_;                // per volume
  std::vector<PhotonMap<D>> maps_;                     // per volume
  std::vector<std::vector<Vec<D>>> positions_;         // of scattered samples, per volume
  std::optional<SurfaceCache<D>> surroundings_;
  std::vector<FineMesh<D>> fine_;
  std::atomic<std::uint64_t> rays_{0};
};

}  // namespace

template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress) {
  return bake(scene, settings, make_plan(scene, settings), progress);
}

template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
              Progress& progress) {
  validate(scene);
  validate(settings);
  const auto start = std::chrono::steady_clock::now();
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  Baked<D> baked = arena.execute([&] { return Baker<D>(scene, settings, plan, progress).run(); });
  baked.statistics.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  baked.statistics.peak_memory_bytes = peak_memory();
  return baked;
}

template Baked<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, Progress&);
template Baked<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&);
template Baked<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, Progress&);
template Baked<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&);

}  // namespace leaflight
