// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/light_sampler.h"

#include <algorithm>
#include <cmath>

#include "leaflight/math/sampling.h"

namespace leaflight {

template <int D>
LightSampler<D>::LightSampler(const SceneTracer<D>& tracer) : tracer_(tracer) {
  double sum = 0;
  for (const RectangleLight<D>& light : tracer.lights()) {
    sum += average(light.radiance) * light.area();
    cumulative_.push_back(sum);
  }
  for (double& c : cumulative_) c /= sum;
}

template <int D>
typename LightSampler<D>::Choice LightSampler<D>::chosen(std::size_t light) const {
  const double below = light > 0 ? cumulative_[light - 1] : 0;
  return {&tracer_.lights()[light], cumulative_[light] - below};
}

template <int D>
typename LightSampler<D>::Choice LightSampler<D>::choose(double u) const {
  return chosen(std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u) -
                cumulative_.begin());
}

template <int D>
double LightSampler<D>::largest_flux() const {
  double flux = 0;
  for (std::size_t i = 0; i < cumulative_.size(); ++i) {
    const Choice choice = chosen(i);
    // A light without power is never chosen.
    if (!(choice.probability > 0)) continue;
    flux = std::max<double>(flux, largest(photon_flux(choice)));
  }
  return flux;
}

// Power of a diffuse emitter: pi A L (thesis Eq. 3.3), 2 length L in the plane (Eq. 3.4).
template <int D>
Rgb LightSampler<D>::photon_flux(const Choice& choice) {
  return choice.light->radiance *
         static_cast<Real>(projected_hemisphere<D> * choice.light->area() / choice.probability);
}

template <int D>
Rgb LightSampler<D>::direct_radiance(const SurfacePoint<D>& point, double choice,
                                     const std::array<double, 2>& u, std::uint64_t& rays) const {
  const Choice picked = choose(choice);
  const RectangleLight<D>& light = *picked.light;
  const Vec<D> target = light.point(u);
  const Vec<D> light_normal = light.normal();
  const Vec<D> way = target - point.position;
  const double distance = way.length();
  if (!(distance > 0)) return Rgb(0);
  const Vec<D> direction = way / distance;
  const double cosine = direction.dot(point.shading_normal);
  const double cosine_light = -direction.dot(light_normal);
  if (!(cosine > 0 && cosine_light > 0 && direction.dot(point.geometric_normal) > 0)) {
    return Rgb(0);
  }
  ++rays;
  if (tracer_.occluded(point, target, light_normal)) return Rgb(0);
  // BRDF albedo / projected_hemisphere; light thins with distance as the sphere, or circle, grows.
  const double spread = D == 3 ? distance * distance : distance;
  const double geometry = cosine * cosine_light * light.area() /
                          (spread * projected_hemisphere<D> * picked.probability);
  return point.albedo * light.radiance * static_cast<Real>(geometry);
}

template <int D>
EmittedPhoton<D> LightSampler<D>::emit(double choice, const std::array<double, 2>& u_position,
                                       const std::array<double, 2>& u_direction) const {
  const Choice picked = choose(choice);
  const RectangleLight<D>& light = *picked.light;
  const Vec<D> normal = light.normal();
  return {leave_plane<D>(light.point(u_position), normal),
          sample_cosine_hemisphere<D>(normal, u_direction), photon_flux(picked)};
}

template class LightSampler<2>;
template class LightSampler<3>;

}  // namespace leaflight
