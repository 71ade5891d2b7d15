// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/low_discrepancy.h"
#include "transport/light_sampler.h"
#include "transport/specular.h"

namespace leaflight {

// The history of a photon at a diffuse surface. `direct`: straight from a light. `caustic`: from a
// light by mirrors and glass only (LS+D). `indirect`: after a diffuse reflection. Photons of
// emissive isosurfaces are indirect from the start, because gather rays sample their direct light.
enum class Arrival { direct, caustic, indirect };

// A photon at a hit of a diffuse surface. Its flux-height is F = Phi H / n (thesis Eq. 4.4). That
// is flux per photon times the height of the isovalue range, since n photons share all isovalues.
// Heights are in units of the isovalue range, so H = 1; the data's units could overflow single
// precision. On isosurfaces it includes the factor |w.Ns| / |w.Ng| of shading normals (Veach 1997,
// ch. 5). So flux per area is irradiance with respect to the shading normal.
template <int D>
struct PhotonHit {
  const Hit<D>& hit;
  const SurfacePoint<D>& point;
  Rgb flux_height;
  Arrival arrival;
};

// Photons to follow: all, or only caustics up to the first diffuse surface.
enum class PhotonPaths { all, caustics };

// The flux-heights of photons by their fate, for the balance of energy.
struct PhotonBalance {
  Imath::V3d emitted{0}, absorbed{0}, escaped{0};
};

// Traces photons with numbers [begin, end) out of `count` and calls deposit(PhotonHit) at each
// diffuse surface. Isovalues are uniform over the isovalue range (thesis 4.3.5), stratified by
// photon number. Returns the number of rays. Adds to `balance`, if given.
template <int D, class Deposit>
std::uint64_t trace_photons(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                            PhotonPaths paths, std::uint64_t seed, std::uint64_t begin,
                            std::uint64_t end, std::uint64_t count, Deposit deposit,
                            PhotonBalance* balance = nullptr);

// Applies Russian roulette that keeps the photons' fluxes similar (thesis 1.3, Jensen 2001).
// Returns the flux of a surviving photon, or zero.
Rgb survivor(const Rgb& flux_height, Real reference_flux, Random& random);

// Returns |w.Ns| / |w.Ng|, or 0 for light from behind the shading normal.
template <int D>
double shading_normal_factor(const SurfacePoint<D>& point, const Vec<D>& direction);

// The random numbers of photon starts.
struct PhotonStream {
  std::uint64_t seed, position_key, direction_key;

  PhotonStream(std::uint64_t stream_seed, PhotonPaths paths)
      : seed(stream_seed ^
             (paths == PhotonPaths::caustics ? 0x63617573746963ull : 0)),  // "caustic"
        position_key(Random(seed ^ 0x706f736974696f6eull).bits()),
        direction_key(Random(seed ^ 0x646972656374696full).bits()) {}

  // Starts photon i of `count`.
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
    for (int specular = 0, diffuse = 0;
         specular < most_specular_bounces && diffuse < most_diffuse_bounces;) {
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
        ++diffuse;
        // Sample the cosine about the geometric normal, through which flux leaves. The flux already
        // includes the factor of the shading normal.
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
