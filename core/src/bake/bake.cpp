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
#include "leaflight/transport/indirect_estimator.h"

namespace leaflight {
namespace {

constexpr std::size_t photons_per_piece = 4096;
constexpr std::size_t texels_per_piece = 64;
constexpr int surroundings_samples = 8;
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
      : settings_(settings),
        plan_(plan),
        progress_(progress),
        tracer_(scene),
        lights_(tracer_),
        lattice_(make_lattice(scene.field, resolution(scene.field, settings), scene.window.min,
                              scene.window.max)) {}

  RadianceGrid<D> run() {
    if (lattice_.active.empty()) {
      throw Error(
          "No isosurface of the isovalue window passes through the volume; widen the window.");
    }
    const bool path = settings_.estimator == EstimatorName::path;
    const double texel_rays = static_cast<double>(lattice_.active.size()) * settings_.samples;
    progress_.expect(
        (plan_.photons ? rays_per_photon * static_cast<double>(settings_.photons) : 0) +
        texel_rays * (1 + indirect_work()));
    if (plan_.photons) trace_photons_into_caches();
    const std::vector<Average> direct = direct_pass();
    std::vector<Average> indirect(direct.size());
    if (plan_.indirect) {
      if (path) {
        indirect = indirect_pass(*make_path_estimator(tracer_, lights_));
      } else if (settings_.estimator == EstimatorName::volumetric) {
        indirect = indirect_pass(*make_volumetric_estimator(*leaves_, lattice_));
      } else {
        std::vector<Rgb> outer_direct(direct.size());
        for (std::size_t s = 0; s < direct.size(); ++s) outer_direct[s] = direct[s].mean;
        indirect = indirect_pass(
            *make_gather_estimator(tracer_, *leaves_, *surroundings_, lattice_, outer_direct));
      }
    }
    return assemble(direct, indirect);
  }

 private:
  static Index<D> resolution(const Field<D>& field, const BakeSettings<D>& settings) {
    return settings.resolution == Index<D>{} ? field.dims : settings.resolution;
  }

  double indirect_work() const {
    if (!plan_.indirect || settings_.estimator == EstimatorName::volumetric) return 0;
    return settings_.estimator == EstimatorName::path ? rays_per_path : rays_per_gather;
  }

  void trace_photons_into_caches() {
    progress_.begin("Tracing photons");
    // The largest flux-height with which any photon starts (thesis Eq. 4.4).
    const double photon_flux = lights_.largest_flux() * tracer_.scene().window.height() /
                               static_cast<double>(settings_.photons);
    leaves_.emplace(tracer_, lattice_, plan_.inner_side, photon_flux, settings_.photons);
    if (plan_.surroundings_cache || settings_.estimator == EstimatorName::gather) {
      surroundings_.emplace(tracer_, photon_flux, settings_.photons);
    }
    parallel_range(settings_.photons, photons_per_piece, rays_per_photon, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     rays_ += trace_photons(tracer_, lights_, settings_.seed, begin, end,
                                            settings_.photons,
                                            [&](const PhotonHit<D>& photon) { store(photon); });
                   });
    leaves_->finish(progress_);
    if (!plan_.surroundings_cache) return;
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

  void store(const PhotonHit<D>& photon) {
    if (photon.point.kind == HitKind::leaf) {
      leaves_->deposit(photon);
    } else if (plan_.surroundings_cache) {
      surroundings_->deposit(photon);
    }
  }

  // Keys of a texel's low-discrepancy sequences; the position key is shared by all passes, so that
  // they see the same points.
  struct TexelKeys {
    std::uint64_t position, light, gather, paths;
  };
  TexelKeys keys(std::uint32_t texel) const {
    Random random = random_for(settings_.seed, Purpose::texel, texel);
    return {random.bits(), random.bits(), random.bits(), random.bits()};
  }

  // Averages radiance(point, keys, i, rays) over the samples of every active texel. The weight
  // |grad h| dV = dA dc makes it a mean over the area of the leaves, which is what a lookup on them
  // wants: steep places are surfaces, flat ones noise.
  template <class Radiance>
  std::vector<Average> over_texels(double work, Radiance radiance) {
    std::vector<Average> averages(lattice_.active.size());
    parallel_range(averages.size(), texels_per_piece, work * settings_.samples, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     std::uint64_t rays = 0;
                     for (std::size_t s = begin; s < end && !progress_.cancelled(); ++s) {
                       const TexelKeys k = keys(lattice_.active[s]);
                       Moments moments;
                       const int n = for_each_texel_sample(
                           tracer_, lattice_, lattice_.active[s], settings_.samples, k.position,
                           [&](const SurfacePoint<D>& point, int i) {
                             moments.add(radiance(point, k, i, rays), point.gradient_length);
                           });
                       averages[s] = moments.average_of(n);
                     }
                     rays_ += rays;
                   });
    return averages;
  }

  std::vector<Average> direct_pass() {
    progress_.begin("Direct light");
    return over_texels(
        1, [&](const SurfacePoint<D>& point, const TexelKeys& k, int i, std::uint64_t& rays) {
          const double choice = sobol_point(i, ~k.light)[0];
          return lights_.direct_radiance(point, choice, sobol_point(i, k.light), rays);
        });
  }

  std::vector<Average> indirect_pass(const IndirectEstimator<D>& estimator) {
    progress_.begin("Indirect light");
    return over_texels(indirect_work(), [&](const SurfacePoint<D>& point, const TexelKeys& k, int i,
                                            std::uint64_t& rays) {
      Random random(k.paths, 0, i);
      return estimator.indirect_radiance(point, sobol_point(i, k.gather), random, rays);
    });
  }

  RadianceGrid<D> assemble(const std::vector<Average>& direct,
                           const std::vector<Average>& indirect) {
    RadianceGrid<D> grid;
    const std::size_t n = direct.size();
    grid.radiance.resize(n);
    grid.radiance_indirect.resize(n);
    grid.radiance_error.resize(n);
    for (std::size_t s = 0; s < n; ++s) {
      grid.radiance[s] = Vec<3, float>(direct[s].mean + indirect[s].mean);
      grid.radiance_indirect[s] = Vec<3, float>(indirect[s].mean);
      grid.radiance_error[s] = std::sqrt(direct[s].variance + indirect[s].variance);
    }
    grid.lattice = std::move(lattice_);
    grid.statistics.rays = rays_;
    grid.statistics.skipped = plan_.skipped;
    return grid;
  }

  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  SceneTracer<D> tracer_;
  LightSampler<D> lights_;
  TexelLattice<D> lattice_;
  std::optional<LeafCache<D>> leaves_;
  std::optional<SurfaceCache<D>> surroundings_;
  std::atomic<std::uint64_t> rays_{0};
};

}  // namespace

template <int D>
RadianceGrid<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress) {
  return bake(scene, settings, make_plan(scene, settings.estimator), progress);
}

template <int D>
RadianceGrid<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                     Progress& progress) {
  validate(scene);
  validate(settings);
  const auto start = std::chrono::steady_clock::now();
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  RadianceGrid<D> grid =
      arena.execute([&] { return Baker<D>(scene, settings, plan, progress).run(); });
  grid.statistics.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  grid.statistics.peak_memory_bytes = peak_memory();
  return grid;
}

template RadianceGrid<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, Progress&);
template RadianceGrid<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&);
template RadianceGrid<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, Progress&);
template RadianceGrid<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&);

}  // namespace leaflight
