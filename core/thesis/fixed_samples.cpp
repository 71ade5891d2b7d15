// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/fixed_samples.h"

#include <tbb/task_arena.h>

#include <chrono>

#include "bake/texels/texel_surface.h"
#include "bake/walls/wall_light.h"
#include "bake/walls/wall_parts.h"
#include "base/platform.h"
#include "base/sampling.h"
#include "thesis/isosurface_passes.h"
#include "thesis/thesis_estimator.h"
#include "transport/placement.h"

namespace leaflight {
namespace {

// Averages of the front and the back; the back is empty if it is not baked.
using SideAverages = std::array<std::vector<Average>, 2>;

constexpr int wall_samples = 8;
// Ratio of the samples of a wall's vertex to those of a texel. Vertices are fewer and farther
// apart.
constexpr int walls_share = 2;

template <int D>
double expected_rays(const FixedBake<D>& bake, const std::vector<SubdividedMesh<D>>& walls) {
  const FixedSettings<D>& settings = bake.settings;
  double points = 0;
  for (std::size_t v = 0; v < bake.lattices.size(); ++v) {
    const std::size_t places =
        bake.scattered ? bake.scattered->positions[v].size() : bake.lattices[v].active.size();
    points += bake.sides() * static_cast<double>(places);
  }
  const double photons = (bake.plan.photons ? settings.photons : 0) +
                         (bake.plan.caustics ? settings.caustic_photons : 0);
  const double wall_rays =
      walls.empty() ? 0
                    : work_of_shadow_rays(bake.tracer, walls) +
                          work_of_samples(bake.tracer, walls, walls_share * settings.samples);
  return rays_per_photon * photons + wall_rays +
         points * settings.samples * (1 + bake.indirect_rays());
}

template <int D>
std::vector<PhotonMap<D>> trace_into_maps(FixedBake<D>& bake) {
  const FixedSettings<D>& settings = bake.settings;
  bake.progress.begin("Tracing photons");
  const auto photons =
      collect_photons(bake.tracer, bake.lights, settings.seed, settings.photons, bake.progress);
  return make_photon_maps(bake.tracer, photons, settings.photon_map);
}

// Returns the radiance that one side of a volume's texels reflects, with the albedo of the
// isosurface in each texel. `direct`: direct light; empty if photons include it.
template <int D>
std::vector<Rgb> side_radiance(const Volume<D>& volume, const IsosurfaceRadiance<D>& isosurface,
                               const std::vector<Average>& direct, bool back) {
  const TexelLattice<D>& lattice = *isosurface.lattice;
  std::vector<Rgb> radiance(lattice.active.size());
  for (std::size_t s = 0; s < radiance.size(); ++s) {
    const Vec<D> center = lattice.center(lattice.active[s]);
    const Rgb albedo = texel_albedo(volume, lattice, s) * volume.texture_at(center);
    radiance[s] = albedo / static_cast<Real>(projected_hemisphere<D>) *
                  isosurface.photons->irradiance(static_cast<std::int32_t>(s), back);
    if (!direct.empty()) radiance[s] += direct[s].mean;
  }
  return radiance;
}

// Makes the estimator, which looks up light of the bake; null if there is no indirect light.
template <int D>
std::unique_ptr<IndirectEstimator<D>> make_estimator(FixedBake<D>& bake,
                                                     const std::vector<SideAverages>& direct) {
  if (!bake.plan.indirect) return nullptr;
  const SurfaceCache<D>* walls = bake.photons.walls.get();
  switch (bake.settings.estimator) {
    case EstimatorName::path:
      return make_path_estimator(bake.tracer, bake.lights);
    case EstimatorName::volumetric:
      return make_volumetric_estimator(bake.isosurfaces, walls);
    case EstimatorName::thesis:
      return make_thesis_estimator(trace_into_maps(bake), walls);
    default:
      for (std::size_t v = 0; v < direct.size(); ++v) {
        for (const bool back : {false, true}) {
          bake.isosurfaces[v].radiance[back] = side_radiance(
              bake.tracer.scene().volumes[v], bake.isosurfaces[v], direct[v][back], back);
        }
      }
      return make_gather_estimator(bake.tracer, bake.lights, bake.isosurfaces, *walls);
  }
}

// Returns the texels on one side of a volume's isosurfaces, in its own lattice.
template <int D>
IsosurfaceTexels<D> texels_of(const FixedBake<D>& bake, std::size_t volume, int side) {
  return {static_cast<int>(volume), side != 0, bake.lattices[volume]};
}

// Computes direct light of all volumes first, because gather rays look it up. Returns it, and
// stores the light of the isosurfaces in the bake.
template <int D>
std::vector<SideAverages> light_directly(FixedBake<D>& bake) {
  const std::size_t volumes = bake.lattices.size();
  bake.isosurfaces.resize(volumes);
  std::vector<SideAverages> direct(volumes);
  for (int side = 0; side < bake.sides(); ++side) {
    bake.progress.begin(side == 0 ? "Direct light" : "Direct light of the back");
    for (std::size_t v = 0; v < volumes; ++v) {
      direct[v][side] = direct_pass(bake, texels_of(bake, v, side));
    }
  }
  for (std::size_t v = 0; v < volumes; ++v) {
    IsosurfaceRadiance<D>& isosurface = bake.isosurfaces[v];
    isosurface.lattice = &bake.lattices[v];
    isosurface.photons =
        bake.photons.isosurfaces.empty() ? nullptr : bake.photons.isosurfaces[v].get();
  }
  return direct;
}

template <int D>
SideAverages light_indirectly(FixedBake<D>& bake, std::size_t volume,
                              const IndirectEstimator<D>* estimator) {
  SideAverages indirect;
  for (int side = 0; side < bake.sides(); ++side) {
    bake.progress.begin(side == 0 ? "Indirect light" : "Indirect light of the back");
    indirect[side] = indirect_pass(bake, texels_of(bake, volume, side), estimator);
  }
  return indirect;
}

// Makes a grid whose errors include those of direct light.
template <int D>
RadianceGrid<D> grid_of(const SideAverages& direct, SideAverages indirect) {
  for (const bool back : {false, true}) {
    for (std::size_t s = 0; s < direct[back].size(); ++s) {
      indirect[back][s].variance += direct[back][s].variance;
    }
  }
  RadianceGrid<D> grid;
  for (const bool back : {false, true}) {
    auto& alone = back ? grid.radiance_back_indirect : grid.radiance_indirect;
    auto& all = back ? grid.radiance_back : grid.radiance;
    for (std::size_t s = 0; s < indirect[back].size(); ++s) {
      alone.push_back(light_precision.rounded(Vec<3, float>(indirect[back][s].mean)));
      const Rgb sum = direct[back][s].mean + Rgb(alone.back());
      all.push_back(light_precision.rounded(Vec<3, float>(sum)));
    }
  }
  for (const Average& front : indirect[0]) {
    grid.radiance_error.push_back(error_precision.rounded(std::sqrt(front.variance)));
  }
  return grid;
}

template <int D>
Baked<D> light(const Scene<D>& scene, const FixedSettings<D>& settings, const Plan& plan,
               Progress& progress) {
  const SceneTracer<D> tracer(scene);
  const LightSampler<D> lights(tracer);
  check_placement(tracer);
  const std::uint64_t rays_before = progress.rays();
  FixedBake<D> bake{tracer,
                    lights,
                    settings,
                    plan,
                    progress,
                    texels_to_bake(scene, settings, plan),
                    scattered_samples(scene, settings)};
  std::vector<SubdividedMesh<D>> walls;
  if (plan.walls) walls = subdivide(scene);
  progress.expect(expected_rays(bake, walls));
  // Trace photons into caches.
  const EstimatorTraits& traits = traits_of(settings.estimator);
  if ((plan.photons && traits.caches) || plan.caustics || plan.wall_cache) {
    const PhotonSettings photons{settings.seed, settings.photons, settings.caustic_photons, true,
                                 traits.walls ? wall_samples : 0};
    bake.photons = trace_into_caches(tracer, lights, bake.lattices, photons, plan, progress);
  }
  // Light the isosurfaces: direct light first, because indirect light looks it up.
  std::vector<SideAverages> direct = light_directly(bake);
  const std::unique_ptr<IndirectEstimator<D>> estimator = make_estimator(bake, direct);
  Baked<D> baked;
  for (std::size_t v = 0; v < direct.size(); ++v) {
    baked.grids.push_back(grid_of<D>(direct[v], light_indirectly(bake, v, estimator.get())));
  }
  // Light the walls.
  if (plan.walls) {
    progress.begin("Lighting walls");
    const auto direct_of_walls =
        std::make_shared<const MeshDirectLight<D>>(tracer, walls, progress);
    const PointSampler<D> sampler = bake.sampler();
    WallParts<D> parts(
        {tracer, walls, sampler, estimator.get(), walls_share * settings.samples, settings.seed});
    baked.walls = parts.radiance(direct_of_walls, progress);
  }
  for (std::size_t v = 0; v < baked.grids.size(); ++v) {
    baked.grids[v].lattice = std::move(bake.lattices[v]);
  }
  baked.statistics.rays = progress.rays() - rays_before;
  baked.statistics.skipped = plan.skipped;
  return baked;
}

}  // namespace

template <int D>
Plan make_plan(const Scene<D>& scene, const FixedSettings<D>& settings) {
  return make_plan(scene, traits_of(settings.estimator), settings.both_sides, settings.walls);
}

template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 Progress& progress) {
  return bake_with_fixed_samples(scene, settings, make_plan(scene, settings), progress);
}

template <int D>
Baked<D> bake_with_fixed_samples(const Scene<D>& scene, const FixedSettings<D>& settings,
                                 const Plan& plan, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  validate(scene);
  validate(settings);
  const Clock::time_point start = Clock::now();
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  Baked<D> baked = arena.execute([&] { return light(scene, settings, plan, progress); });
  baked.statistics.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  baked.statistics.peak_memory_bytes = peak_memory();
  return baked;
}

template Plan make_plan(const Scene<2>&, const FixedSettings<2>&);
template Plan make_plan(const Scene<3>&, const FixedSettings<3>&);
template Baked<2> bake_with_fixed_samples(const Scene<2>&, const FixedSettings<2>&, Progress&);
template Baked<3> bake_with_fixed_samples(const Scene<3>&, const FixedSettings<3>&, Progress&);
template Baked<2> bake_with_fixed_samples(const Scene<2>&, const FixedSettings<2>&, const Plan&,
                                          Progress&);
template Baked<3> bake_with_fixed_samples(const Scene<3>&, const FixedSettings<3>&, const Plan&,
                                          Progress&);

}  // namespace leaflight
