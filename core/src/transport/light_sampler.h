// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "math/random.h"
#include "transport/environment_sampler.h"
#include "transport/isosurface_emitter.h"
#include "transport/light_points.h"

namespace leaflight {

// A photon at the beginning of its way.
template <int D>
struct PhotonStart {
  SurfacePoint<D> from;  // of kind none where it does not start on a surface
  Vec<D> direction{0.0};
  Rgb flux_height{0};  // of all lights, as this photon alone would carry it; 0: no photon
  bool from_isosurface =
      false;  // emitted by an isosurface, which direct_radiance() does not sample
};

// All that emits: the scene's lights, its emissive meshes, its environment and its emissive
// isosurfaces, chosen among by their power. Isosurfaces are left to the rays that hit them, and to
// photons.
template <int D>
class LightSampler {
 public:
  explicit LightSampler(const SceneTracer<D>& tracer);
  // Direct light is that of no points alone.
  LightSampler(const SceneTracer<D>& tracer, const SplitLight<D>& split);

  // One-sample estimate of the radiance that a surface point reflects of direct light; `choice` and
  // `u` uniform in [0,1). Adds the number of rays traced to `rays`.
  Rgb direct_radiance(const SurfacePoint<D>& point, double choice, const std::array<double, 2>& u,
                      std::uint64_t& rays) const;

  // The same for the isovalues of all isosurfaces at once.
  struct ForAllIsovalues {
    Rgb radiance{0};  // beside those that do not block its way
    BlockingIsovalues blocked{0, 0};
  };
  ForAllIsovalues direct_radiance_for_all(const SurfacePoint<D>& point, double choice,
                                          const std::array<double, 2>& u,
                                          std::uint64_t& rays) const;

  // A source that stands for all that direct_radiance() samples; precondition: can_light().
  LightSource<D> source(double choice, const std::array<double, 2>& u) const;
  bool can_light() const { return !by_irradiance_.empty(); }

  // `c`: the common isovalue of the photon, unless it starts on an isosurface.
  PhotonStart<D> emit(double c, double choice, const std::array<double, 2>& u_position,
                      const std::array<double, 2>& u_direction, Random& random) const;

  // The radiance of lights and environment that a ray finds which ends at t_max, or nowhere:
  // what direct_radiance() samples, but for the emission of the surface at the end.
  Rgb visible_radiance(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;

  // Whether direct_radiance() looks at its `choice`.
  bool has_choice() const { return by_irradiance_.size() > 1; }

  // The largest channel of the flux-height of any emitted photon.
  double largest_flux_height() const;

 private:
  LightSampler(const SceneTracer<D>& tracer, const std::optional<Environment<D>>& environment,
               const SplitLight<D>* split);
  // Numbers: lights first, then meshes, the environment, isosurfaces.
  std::size_t first_mesh() const { return tracer_.lights().size(); }
  std::size_t environment_number() const { return first_mesh() + meshes_.size(); }
  std::size_t first_isosurface() const { return environment_number() + (environment_ ? 1 : 0); }
  LightSample<D> sample(const DiscreteDistribution::Pick& pick, const SurfacePoint<D>& point,
                        const std::array<double, 2>& u) const;
  // A sample of what direct_radiance() seeks; its radiance is what is reflected if it is not
  // hidden.
  LightSample<D> reflected(const SurfacePoint<D>& point, double choice,
                           const std::array<double, 2>& u) const;

  const SceneTracer<D>& tracer_;
  std::vector<MeshEmitter<D>> meshes_;
  std::optional<EnvironmentSampler<D>> environment_;
  std::vector<IsosurfaceEmitter<D>> isosurfaces_;
  DiscreteDistribution by_power_, by_irradiance_;
};

}  // namespace leaflight
