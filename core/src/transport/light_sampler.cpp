// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/light_sampler.h"

#include <algorithm>
#include <limits>

#include "base/sampling.h"

namespace leaflight {

template <int D>
LightSampler<D>::LightSampler(const SceneTracer<D>& tracer)
    : LightSampler(tracer, tracer.scene().environment, nullptr) {}

template <int D>
LightSampler<D>::LightSampler(const SceneTracer<D>& tracer, const SplitLight<D>& split)
    : LightSampler(tracer, split.wide, &split) {}

template <int D>
LightSampler<D>::LightSampler(const SceneTracer<D>& tracer,
                              const std::optional<Environment<D>>& environment,
                              const SplitLight<D>* split)
    : tracer_(tracer) {
  const Scene<D>& scene = tracer.scene();
  std::vector<char> is_sampled;  // one per emissive mesh
  for (std::size_t m = 0; m < tracer.meshes().size(); ++m) {
    const Mesh<D>& mesh = tracer.meshes()[m];
    if (!(largest(mesh.emission) > 0)) continue;
    meshes_.emplace_back(mesh);
    is_sampled.push_back(!split || split->mesh_is_wide[m]);
  }
  if (environment && largest(environment->radiance) > 0) environment_.emplace(*environment);
  for (std::size_t v = 0; v < scene.volumes.size(); ++v) {
    IsosurfaceEmitter<D> isosurface(tracer, static_cast<int>(v));
    if (isosurface.power_height() > 0) isosurfaces_.push_back(std::move(isosurface));
  }
  std::vector<double> power, near;
  for (const Light<D>& light : tracer.lights()) {
    power.push_back(std::visit([&](const auto& l) { return l.power(tracer.bounds()); }, light));
    const double near_one = std::visit([](const auto& l) { return l.near_irradiance(); }, light);
    near.push_back(split ? 0 : near_one);
  }
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const MeshEmitter<D>& mesh = meshes_[m];
    power.push_back(mesh.power());
    near.push_back(is_sampled[m] ? average(mesh.radiance()) * mesh.area() / (1 + mesh.area()) : 0);
  }
  if (environment_) {
    power.push_back(environment_->power(tracer.bounds()));
    near.push_back(pi * power.back() / (all_directions<D> * tracer.bounds().parallel_area()));
  }
  for (const IsosurfaceEmitter<D>& isosurface : isosurfaces_) {
    power.push_back(isosurface.power_height());
  }
  // A tenth of the shadow rays is uniform over all lights, in case the center of the scene is not
  // typical.
  double sum = 0, shining = 0;
  for (const double n : near) sum += n, shining += n > 0;
  for (double& n : near) n = n > 0 ? 0.9 * n / sum + 0.1 / shining : 0;
  by_power_ = DiscreteDistribution(std::move(power));
  if (shining > 0) by_irradiance_ = DiscreteDistribution(std::move(near));
}

template <int D>
double LightSampler<D>::largest_flux_height() const {
  double most = 0;
  const auto consider = [&](std::size_t number, double flux_height) {
    const double p = by_power_.probability(number);
    // Lights without power are never chosen.
    if (p > 0) most = std::max(most, flux_height / p);
  };
  const auto of_lamp = [&](const auto& lamp) { return lamp.largest_flux(tracer_.bounds()); };
  for (std::size_t i = 0; i < tracer_.lights().size(); ++i) {
    consider(i, std::visit(of_lamp, tracer_.lights()[i]));
  }
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    const double radiance = largest(meshes_[i].radiance());
    consider(first_mesh() + i, radiance * 2 * projected_hemisphere<D> * meshes_[i].area());
  }
  if (environment_) {
    consider(environment_number(), environment_->largest_flux(tracer_.bounds()));
  }
  for (std::size_t i = 0; i < isosurfaces_.size(); ++i) {
    consider(first_isosurface() + i, isosurfaces_[i].largest_flux_height());
  }
  return most;
}

template <int D>
LightSample<D> LightSampler<D>::sample(const DiscreteDistribution::Pick& pick,
                                       const SurfacePoint<D>& point,
                                       const std::array<double, 2>& u) const {
  if (pick.index < first_mesh()) {
    return std::visit([&](const auto& lamp) { return lamp.sample(point.position, u); },
                      tracer_.lights()[pick.index]);
  }
  if (pick.index < environment_number()) {
    return meshes_[pick.index - first_mesh()].sample(point.position, pick.rest, u);
  }
  return environment_->sample(point.shading_normal, u);
}

template <int D>
LightSample<D> LightSampler<D>::reflected(const SurfacePoint<D>& point, double choice,
                                          const std::array<double, 2>& u) const {
  if (by_irradiance_.empty()) return {};
  const auto picked = by_irradiance_.pick(choice);
  LightSample<D> light = sample(picked, point, u);
  const double cosine = light.direction.dot(point.shading_normal);
  if (!(cosine > 0 && light.direction.dot(point.geometric_normal) > 0)) return {};
  // The BRDF is albedo / projected_hemisphere.
  light.radiance *=
      point.albedo * static_cast<Real>(cosine / (projected_hemisphere<D> * picked.probability));
  return light;
}

template <int D>
Rgb LightSampler<D>::direct_radiance(const SurfacePoint<D>& point, double choice,
                                     const std::array<double, 2>& u, std::uint64_t& rays) const {
  const LightSample<D> light = reflected(point, choice, u);
  if (!(largest(light.radiance) > 0)) return Rgb(0);
  ++rays;
  const bool hidden = light.infinite ? tracer_.occluded(point, light.direction)
                                     : tracer_.occluded(point, light.end, light.end_normal);
  return hidden ? Rgb(0) : light.radiance;
}

template <int D>
typename LightSampler<D>::ForAllIsovalues LightSampler<D>::direct_radiance_for_all(
    const SurfacePoint<D>& point, double choice, const std::array<double, 2>& u,
    std::uint64_t& rays) const {
  const LightSample<D> light = reflected(point, choice, u);
  if (!(largest(light.radiance) > 0)) return {};
  ++rays;
  return {light.radiance, light.infinite ? tracer_.blocking(point, light.direction)
                                         : tracer_.blocking(point, light.end, light.end_normal)};
}

template <int D>
PhotonStart<D> LightSampler<D>::emit(double c, double choice,
                                     const std::array<double, 2>& u_position,
                                     const std::array<double, 2>& u_direction,
                                     Random& random) const {
  const auto picked = by_power_.pick(choice);
  PhotonStart<D> start;
  if (picked.index >= first_isosurface()) {
    const auto sample = isosurfaces_[picked.index - first_isosurface()].sample(picked.rest, random);
    if (sample.point.kind() == HitKind::none) return start;
    start.from = sample.point;
    start.direction = sample_cosine_hemisphere<D>(sample.point.geometric_normal, u_direction);
    start.flux_height = sample.flux_height / static_cast<Real>(picked.probability);
    start.from_isosurface = true;
    return start;
  }
  EmittedPhoton<D> photon;
  if (picked.index < first_mesh()) {
    photon = std::visit(
        [&](const auto& lamp) { return lamp.emit(tracer_.bounds(), u_position, u_direction); },
        tracer_.lights()[picked.index]);
  } else if (picked.index < environment_number()) {
    photon = meshes_[picked.index - first_mesh()].emit(picked.rest, u_position, u_direction);
  } else {
    photon = environment_->emit(tracer_.bounds(), u_position, u_direction);
  }
  start.from.position = photon.origin;
  start.from.c = c;
  start.direction = photon.direction;
  start.flux_height = photon.flux / static_cast<Real>(picked.probability);
  return start;
}

template <int D>
Rgb LightSampler<D>::visible_radiance(const Vec<D>& origin, const Vec<D>& direction,
                                      double t_max) const {
  Rgb radiance(0);
  for (const Light<D>& light : tracer_.lights()) {
    radiance += std::visit(
        [&](const auto& lamp) { return lamp.radiance_along(origin, direction, t_max); }, light);
  }
  if (environment_ && !(t_max < std::numeric_limits<double>::infinity())) {
    radiance += environment_->radiance(direction);
  }
  return radiance;
}

template class LightSampler<2>;
template class LightSampler<3>;

}  // namespace leaflight
