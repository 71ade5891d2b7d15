// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/indirect_shares.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "base/error.h"
#include "transport/environment_sampler.h"
#include "transport/isosurface_emitter.h"
#include "transport/light_points.h"
#include "transport/mesh_emitter.h"

namespace leaflight {
namespace {

constexpr int paths = 1 << 14;

// True if a sampled diffuse reflection at a point hits an isosurface.
template <int D>
bool reaches_isosurface(const SceneTracer<D>& tracer, const SurfacePoint<D>& from, Random& random) {
  const Vec<D> direction = sample_cosine_hemisphere<D>(from.geometric_normal, random.pair());
  return tracer.intersect(from, direction).kind == HitKind::isosurface;
}

// Returns the mean of flux_of(random numbers) over all paths, which are traced in parallel. The
// order of the sum is fixed.
template <class Flux>
Imath::V3d mean_of_paths(Flux flux_of) {
  std::vector<Imath::V3d> fluxes(paths);
  tbb::parallel_for(tbb::blocked_range<int>(0, paths, 256), [&](const auto& range) {
    for (int i = range.begin(); i < range.end(); ++i) {
      Random random = random_for(0, Purpose::photon, i);
      fluxes[i] = flux_of(random);
    }
  });
  Imath::V3d sum(0);
  for (const Imath::V3d& flux : fluxes) sum += flux / paths;
  return sum;
}

template <int D>
class Paths {
 public:
  explicit Paths(const SceneTracer<D>& tracer) : tracer_(tracer) {}

  // Returns the mean flux from a lamp that reaches isosurfaces. The callback `emit` makes a photon
  // from random numbers, which are the same for every lamp. `unreflected`: true if photons count
  // before their first reflection.
  template <class Emit>
  Imath::V3d mean_flux(Emit emit, bool unreflected) const {
    return mean_of_paths([&](Random& random) {
      const IsovalueRange& isovalue_range = tracer_.scene().isovalue_range;
      const double c = isovalue_range.min + random.uniform() * isovalue_range.height();
      const EmittedPhoton<D> photon = emit(random);
      if (!(largest(photon.flux) > 0)) return Imath::V3d(0);
      return reaching(photon, c, unreflected, random);
    });
  }

 private:
  Imath::V3d reaching(const EmittedPhoton<D>& photon, double c, bool unreflected,
                      Random& random) const {
    const auto first = tracer_.intersect(photon.origin, photon.direction, c);
    const SurfacePoint<D> point = tracer_.surface_point(first, photon.direction, c);
    if (point.kind() == HitKind::none) return Imath::V3d(0);
    Imath::V3d flux(0);
    if (unreflected && point.kind() == HitKind::isosurface) flux += Imath::V3d(photon.flux);
    if (reaches_isosurface(tracer_, point, random)) flux += Imath::V3d(photon.flux * point.albedo);
    return flux;
  }

  const SceneTracer<D>& tracer_;
};

// Returns light after one bounce between isosurfaces; it is most of their indirect light.
template <int D>
Imath::V3d flux_from_isosurfaces(const SceneTracer<D>& tracer,
                                 const IsosurfaceEmitter<D>& isosurfaces) {
  return mean_of_paths([&](Random& random) {
    const auto sample = isosurfaces.sample(random.uniform(), random);
    const bool reaches =
        sample.point.kind() != HitKind::none && reaches_isosurface(tracer, sample.point, random);
    return reaches ? Imath::V3d(sample.flux_height) : Imath::V3d(0);
  });
}

}  // namespace

Rgb IndirectShares::factor(const std::vector<Rgb>& factors) const {
  if (factors.size() != lights.size()) throw Error("Each light of the scene needs a factor.");
  Imath::V3d before = others, after = others, mean(lights.empty() ? 1 : 0);
  for (std::size_t l = 0; l < lights.size(); ++l) {
    before += lights[l];
    after += lights[l] * Imath::V3d(factors[l]);
    mean += Imath::V3d(factors[l]) / static_cast<double>(lights.size());
  }
  Rgb factor;
  for (int i = 0; i < 3; ++i) {
    factor[i] = static_cast<Real>(before[i] > 0 ? after[i] / before[i] : mean[i]);
  }
  return factor;
}

Imath::V3d IndirectShares::total() const {
  Imath::V3d sum = others;
  for (const Imath::V3d& light : lights) sum += light;
  return sum;
}

template <int D>
IndirectShares indirect_shares(const SceneTracer<D>& tracer) {
  const Scene<D>& scene = tracer.scene();
  const Paths<D> paths_from(tracer);
  const std::vector<char> is_wide = split_light(tracer).mesh_is_wide;
  IndirectShares shares;
  // Trace paths from each lamp.
  for (const Light<D>& light : tracer.lights()) {
    const auto emit = [&](Random& random) {
      const auto u = random.pair();
      const auto v = random.pair();
      return std::visit([&](const auto& l) { return l.emit(tracer.bounds(), u, v); }, light);
    };
    shares.lights.push_back(paths_from.mean_flux(emit, false));
  }
  // Trace paths from all other emitters: meshes, the environment and isosurfaces.
  for (std::size_t m = 0; m < tracer.meshes().size(); ++m) {
    if (!(largest(tracer.meshes()[m].emission) > 0)) continue;
    const MeshEmitter<D> mesh(tracer.meshes()[m]);
    const auto emit = [&](Random& random) {
      const double choice = random.uniform();
      const auto u = random.pair();
      return mesh.emit(choice, u, random.pair());
    };
    shares.others += paths_from.mean_flux(emit, is_wide[m] != 0);
  }
  if (scene.environment && largest(scene.environment->radiance) > 0) {
    const EnvironmentSampler<D> environment(*scene.environment);
    const auto emit = [&](Random& random) {
      const auto u = random.pair();
      return environment.emit(tracer.bounds(), u, random.pair());
    };
    shares.others += paths_from.mean_flux(emit, true);
  }
  for (std::size_t v = 0; v < scene.volumes.size(); ++v) {
    const IsosurfaceEmitter<D> isosurfaces(tracer, static_cast<int>(v));
    if (!(isosurfaces.power_height() > 0)) continue;
    shares.others += flux_from_isosurfaces(tracer, isosurfaces);
  }
  return shares;
}

template IndirectShares indirect_shares(const SceneTracer<2>&);
template IndirectShares indirect_shares(const SceneTracer<3>&);

}  // namespace leaflight
