// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/random.h"
#include "transport/environment_sampler.h"
#include "transport/isosurface_emitter.h"
#include "transport/light_points.h"

namespace leaflight {

// A photon at its start.
template <int D>
struct PhotonStart {
  SurfacePoint<D> from;  // of kind none if it does not start on a surface
  Vec<D> direction{0.0};
  Rgb flux_height{0};  // of all lights, if this were the only photon; 0: no photon
  bool from_isosurface =
      false;  // emitted by an isosurface, which direct_radiance() does not sample
};

// All emitters: lights, emissive meshes, the environment and emissive isosurfaces, chosen by power.
// Shadow rays do not sample isosurfaces; gather rays and photons do.
template <int D>
class LightSampler {
 public:
  explicit LightSampler(const SceneTracer<D>& tracer);
  // Samples direct light without the light points.
  LightSampler(const SceneTracer<D>& tracer, const SplitLight<D>& split);

  // Returns a one-sample estimate of the direct light that a surface point reflects. `choice` and
  // `u`: uniform in [0,1). Adds the traced rays to `rays`.
  Rgb direct_radiance(const SurfacePoint<D>& point, double choice, const std::array<double, 2>& u,
                      std::uint64_t& rays) const;

  // Direct light for the isovalues of all isosurfaces at once.
  struct ForAllIsovalues {
    Rgb radiance{0};  // for isovalues that do not block its way
    BlockingIsovalues blocked{0, 0};
  };
  ForAllIsovalues direct_radiance_for_all(const SurfacePoint<D>& point, double choice,
                                          const std::array<double, 2>& u,
                                          std::uint64_t& rays) const;

  // True if direct_radiance() may return light.
  bool can_light() const { return !by_irradiance_.empty(); }

  // Emits a photon. `c`: its common isovalue, unless it starts on an isosurface.
  PhotonStart<D> emit(double c, double choice, const std::array<double, 2>& u_position,
                      const std::array<double, 2>& u_direction, Random& random) const;

  // Returns the radiance of lights and environment along a ray that ends at t_max, or never. It is
  // the light of direct_radiance() without the emission of the surface at the end.
  Rgb visible_radiance(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;

  // True if direct_radiance() uses its `choice`.
  bool has_choice() const { return by_irradiance_.size() > 1; }

  // Returns the largest channel of the flux-height of any emitted photon.
  double largest_flux_height() const;

 private:
  LightSampler(const SceneTracer<D>& tracer, const std::optional<Environment<D>>& environment,
               const SplitLight<D>* split);
  // Emitters are numbered: lights, then meshes, the environment, isosurfaces.
  std::size_t first_mesh() const { return tracer_.lights().size(); }
  std::size_t environment_number() const { return first_mesh() + meshes_.size(); }
  std::size_t first_isosurface() const { return environment_number() + (environment_ ? 1 : 0); }
  LightSample<D> sample(const DiscreteDistribution::Pick& pick, const SurfacePoint<D>& point,
                        const std::array<double, 2>& u) const;
  // Samples direct light; the radiance is the reflected one if nothing blocks its way.
  LightSample<D> reflected(const SurfacePoint<D>& point, double choice,
                           const std::array<double, 2>& u) const;

  const SceneTracer<D>& tracer_;
  std::vector<MeshEmitter<D>> meshes_;
  std::optional<EnvironmentSampler<D>> environment_;
  std::vector<IsosurfaceEmitter<D>> isosurfaces_;
  DiscreteDistribution by_power_, by_irradiance_;
};

}  // namespace leaflight
