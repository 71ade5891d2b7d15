// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/low_discrepancy.h"
#include "transport/light_sampler.h"
#include "transport/specular.h"

namespace leaflight {

// How a photon came to a diffuse surface: straight from a light; from a light by mirrors and glass
// alone (LS+D, a caustic); or after a diffuse reflection. Photons of emissive isosurfaces are
// indirect from the start, since their direct light is no estimator's but the gathered one.
enum class Arrival { direct, caustic, indirect };

// A photon where it hits a diffuse surface. Its flux-height is F = Phi H / n (thesis Eq. 4.4):
// flux per photon times the height of the isovalue range, since n photons share all isovalues.
// Heights are in units of the isovalue range's, H = 1: in those of the data, single precision would
// underflow or overflow. On leaves it carries the factor |w.Ns| / |w.Ng| of shading normals (Veach
// 1997, ch. 5), so that flux per area is irradiance with respect to the shading normal.
template <int D>
struct PhotonHit {
  const Hit<D>& hit;
  const SurfacePoint<D>& point;
  Rgb flux_height;
  Arrival arrival;
};

// Which photons are followed: all, or those of caustics, up to the first diffuse surface.
enum class PhotonPaths { all, caustics };

// What became of the photons' flux-height, for the balance of energy.
struct PhotonBalance {
  Imath::V3d emitted{0}, absorbed{0}, escaped{0};
};

// Traces photons of numbers [begin, end) out of `count` and calls deposit(PhotonHit) at each
// diffuse surface. Isovalues are uniform over the isovalue range (thesis 4.3.5), stratified by
// photon number. Returns the number of rays traced. `balance`, if given, is added to.
template <int D, class Deposit>
std::uint64_t trace_photons(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                            PhotonPaths paths, std::uint64_t seed, std::uint64_t begin,
                            std::uint64_t end, std::uint64_t count, Deposit deposit,
                            PhotonBalance* balance = nullptr);

// Russian roulette that keeps the photons' fluxes alike (thesis 1.3, Jensen 2001): the flux if the
// photon survives, zero if it does not.
Rgb survivor(const Rgb& flux_height, Real reference_flux, Random& random);

// |w.Ns| / |w.Ng|, 0 where the light would come from behind the shading normal.
template <int D>
double shading_normal_factor(const SurfacePoint<D>& point, const Vec<D>& direction);

// The random numbers with which photons start.
struct PhotonStream {
  std::uint64_t seed, position_key, direction_key;

  PhotonStream(std::uint64_t of, PhotonPaths paths)
      : seed(of ^ (paths == PhotonPaths::caustics ? 0x63617573746963ull : 0)),  // "caustic"
        position_key(Random(seed ^ 0x706f736974696f6eull).bits()),
        direction_key(Random(seed ^ 0x646972656374696full).bits()) {}

  // That of photon i of `count`.
  template <int D>
  PhotonStart<D> start(const LightSampler<D>& lights, const IsovalueRange& isovalue_range,
                       std::uint64_t i, std::uint64_t count, Random& random) const {
    const auto index = static_cast<std::uint32_t>(i);
    const double c = isovalue_range.min + isovalue_range.height() *
                                              ((i + random.uniform()) / static_cast<double>(count));
    const double choice = random.uniform();
    return lights.emit(c, choice, sobol_point(index, position_key),
                       sobol_point(index, direction_key), random);
  }
};

template <int D, class Deposit>
std::uint64_t trace_photons(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                            PhotonPaths paths, std::uint64_t seed, std::uint64_t begin,
                            std::uint64_t end, std::uint64_t count, Deposit deposit,
                            PhotonBalance* balance) {
  const PhotonStream stream(seed, paths);
  std::uint64_t rays = 0;
  for (std::uint64_t i = begin; i < end; ++i) {
    Random random = random_for(stream.seed, Purpose::photon, i);
    const PhotonStart<D> start =
        stream.start(lights, tracer.scene().isovalue_range, i, count, random);
    Rgb flux_height = start.flux_height / static_cast<Real>(count);
    const Real reference_flux = largest(flux_height);
    if (!(reference_flux > 0)) continue;
    if (balance) balance->emitted += Imath::V3d(flux_height);
    Vec<D> direction = start.direction;
    Arrival arrival = start.from_isosurface ? Arrival::indirect : Arrival::direct;
    SurfacePoint<D> from = start.from;
    for (int specular = 0; specular < most_specular_bounces;) {
      ++rays;
      const Hit<D> hit = tracer.intersect(from, direction);
      if (hit.kind == HitKind::none) {
        if (balance) balance->escaped += Imath::V3d(flux_height);
        break;
      }
      const SurfacePoint<D> point = tracer.surface_point(hit, direction, from.c);
      Rgb arriving = flux_height;
      if (point.scattering == Scattering::diffuse) {
        arriving = flux_height *= static_cast<Real>(shading_normal_factor(point, direction));
        if (paths == PhotonPaths::all || arrival == Arrival::caustic) {
          deposit(PhotonHit<D>{hit, point, flux_height, arrival});
        }
        if (paths == PhotonPaths::caustics) break;
        flux_height *= point.albedo;
        arrival = Arrival::indirect;
        // The density cos / pi is about the geometric normal, which is what flux leaves through;
        // the shading normal's part is in the flux already.
        from = point;
      } else {
        const SpecularBounce<D> bounce = specular_bounce(point, direction, random.uniform());
        flux_height *= bounce.weight;
        direction = bounce.direction;
        if (arrival == Arrival::direct) arrival = Arrival::caustic;
        from = bounce.from;
        ++specular;
      }
      if (balance) balance->absorbed += Imath::V3d(arriving - flux_height);
      flux_height = survivor(flux_height, reference_flux, random);
      if (!(largest(flux_height) > 0)) break;
      if (point.scattering == Scattering::diffuse) {
        const double u = random.uniform();
        direction = sample_cosine_hemisphere<D>(point.geometric_normal, {u, random.uniform()});
      }
    }
  }
  return rays;
}

}  // namespace leaflight
