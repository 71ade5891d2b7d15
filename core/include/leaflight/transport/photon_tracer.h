// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/math/low_discrepancy.h"
#include "leaflight/transport/light_sampler.h"

namespace leaflight {

// A photon where it meets a diffuse surface. Its flux-height is F = Phi H / n (thesis Eq. 4.4):
// flux per photon times the height of the isovalue window, since n photons share all isovalues. On
// leaves it carries the factor |w.Ns| / |w.Ng| of shading normals (Veach 1997, ch. 5), so that flux
// per area is irradiance with respect to the shading normal.
template <int D>
struct PhotonHit {
  const Hit<D>& hit;
  const SurfacePoint<D>& point;
  Rgb flux_height;
  bool direct;  // came straight from a light
};

// Traces photons of numbers [begin, end) out of `count` and calls deposit(PhotonHit) at each
// diffuse surface. Isovalues are uniform over the window (thesis 4.3.5), stratified by photon
// number. Returns the number of rays traced.
template <int D, class Deposit>
std::uint64_t trace_photons(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                            std::uint64_t seed, std::uint64_t begin, std::uint64_t end,
                            std::uint64_t count, Deposit deposit);

// The reflected flux of a photon: the direction has density cos / pi about the geometric normal,
// which is what flux leaves through; the shading normal's part is in the hit's flux already.
template <int D>
struct Reflection {
  bool survives;
  Vec<D> direction;
  Rgb flux_height;
};
template <int D>
Reflection<D> reflect_photon(const PhotonHit<D>& arrival, Real reference_flux, Random& random);

// |w.Ns| / |w.Ng|, 0 where the light would come from behind the shading normal.
template <int D>
double shading_normal_factor(const SurfacePoint<D>& point, const Vec<D>& direction);

template <int D, class Deposit>
std::uint64_t trace_photons(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                            std::uint64_t seed, std::uint64_t begin, std::uint64_t end,
                            std::uint64_t count, Deposit deposit) {
  const IsovalueWindow& window = tracer.scene().window;
  const std::uint64_t position_key = Random(seed ^ 0x706f736974696f6eull).bits();
  const std::uint64_t direction_key = Random(seed ^ 0x646972656374696full).bits();
  std::uint64_t rays = 0;
  for (std::uint64_t i = begin; i < end; ++i) {
    Random random = random_for(seed, Purpose::photon, i);
    const auto index = static_cast<std::uint32_t>(i);
    const double c =
        window.min + window.height() * ((i + random.uniform()) / static_cast<double>(count));
    const EmittedPhoton<D> photon = lights.emit(random.uniform(), sobol_point(index, position_key),
                                                sobol_point(index, direction_key));
    Rgb flux_height = photon.flux * static_cast<Real>(window.height() / static_cast<double>(count));
    const Real reference_flux = largest(flux_height);
    Vec<D> direction = photon.direction;
    ++rays;
    Hit<D> hit = tracer.intersect(photon.origin, direction, c);
    for (bool direct = true; hit.kind != HitKind::none; direct = false) {
      const SurfacePoint<D> point = tracer.surface_point(hit, direction, c);
      flux_height *= static_cast<Real>(shading_normal_factor(point, direction));
      const PhotonHit<D> arrival{hit, point, flux_height, direct};
      deposit(arrival);
      const Reflection<D> reflection = reflect_photon(arrival, reference_flux, random);
      if (!reflection.survives) break;
      flux_height = reflection.flux_height;
      direction = reflection.direction;
      ++rays;
      hit = tracer.intersect(point, direction);
    }
  }
  return rays;
}

}  // namespace leaflight
