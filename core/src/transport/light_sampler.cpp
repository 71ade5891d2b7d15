// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/light_sampler.h"

#include <algorithm>
#include <cmath>

#include "leaflight/math/sampling.h"

namespace leaflight {

LightSampler::LightSampler(const SceneTracer& tracer) : tracer_(tracer) {
  double sum = 0;
  for (const RectangleLight& light : tracer.lights()) {
    sum += average(light.radiance) * light.area();
    cumulative_.push_back(sum);
  }
  for (double& c : cumulative_) c /= sum;
}

LightSampler::Choice LightSampler::choose(double u) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  const std::size_t i = found - cumulative_.begin();
  const double below = i > 0 ? cumulative_[i - 1] : 0;
  return {&tracer_.lights()[i], cumulative_[i] - below};
}

Rgb LightSampler::direct_radiance(const SurfacePoint& point, double choice,
                                  const std::array<double, 2>& u, std::uint64_t& rays) const {
  const Choice chosen = choose(choice);
  const RectangleLight& light = *chosen.light;
  const Vec3 target = light.point(u[0], u[1]);
  const Vec3 light_normal = light.normal();
  const Vec3 way = target - point.position;
  const double distance2 = way.length2();
  const double distance = std::sqrt(distance2);
  if (!(distance > 0)) return Rgb(0);
  const Vec3 direction = way / distance;
  const double cosine = direction.dot(point.shading_normal);
  const double cosine_light = -direction.dot(light_normal);
  if (!(cosine > 0 && cosine_light > 0 && direction.dot(point.geometric_normal) > 0)) {
    return Rgb(0);
  }
  ++rays;
  if (tracer_.occluded(point, target, light_normal)) return Rgb(0);
  const double geometry =
      cosine * cosine_light * light.area() / (distance2 * pi * chosen.probability);
  return point.albedo * light.radiance * static_cast<Real>(geometry);
}

EmittedPhoton LightSampler::emit(double choice, const std::array<double, 2>& u_position,
                                 const std::array<double, 2>& u_direction) const {
  const Choice chosen = choose(choice);
  const RectangleLight& light = *chosen.light;
  // Power of a diffuse emitter: pi A L (thesis Eq. 3.3).
  const auto weight = static_cast<Real>(pi * light.area() / chosen.probability);
  const Vec3 normal = light.normal();
  return {leave_plane(light.point(u_position[0], u_position[1]), normal),
          sample_cosine_hemisphere(normal, u_direction), light.radiance * weight};
}

}  // namespace leaflight
