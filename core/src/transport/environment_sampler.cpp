// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/environment_sampler.h"

#include <algorithm>
#include <cmath>

namespace leaflight {
namespace {

// Returns the image coordinates of a unit direction in the image's frame, by the formula of
// Blender's equirectangular textures.
std::array<double, 2> image_coordinates(const Vec3& d) {
  return {0.5 - std::atan2(d.y, d.x) / (2 * pi), 0.5 + std::asin(std::clamp(d.z, -1.0, 1.0)) / pi};
}

Vec3 image_direction(double u, double v) {
  const double azimuth = (0.5 - u) * 2 * pi, height = (v - 0.5) * pi;
  return {std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth),
          std::sin(height)};
}

}  // namespace

template <int D>
EnvironmentSampler<D>::EnvironmentSampler(const Environment<D>& environment)
    : environment_(environment) {
  if constexpr (D == 3) {
    if (!environment.image) return;
    image_to_world_ = inverse(environment.world_to_image);
    const Texture& image = *environment.image;
    std::vector<double> rows;
    for (int j = 0; j < image.height; ++j) {
      std::vector<double> row(image.width, 0.0);
      for (int i = 0; i < image.width; ++i) {
        // Include the neighbors, between which the image is interpolated. Otherwise light could
        // come from directions that are never sampled.
        for (int dj = -1; dj <= 1; ++dj) {
          const int y = (j + dj + image.height) % image.height;
          for (int di = -1; di <= 1; ++di) {
            const int x = (i + di + image.width) % image.width;
            const auto& p = image.pixels[static_cast<std::size_t>(y) * image.width + x];
            row[i] += p.x + p.y + p.z;
          }
        }
      }
      columns_.emplace_back(std::move(row));
      rows.push_back(columns_.back().total() * std::cos(((j + 0.5) / image.height - 0.5) * pi));
    }
    rows_ = DiscreteDistribution(std::move(rows));
  }
}

template <int D>
Rgb EnvironmentSampler<D>::radiance(const Vec<D>& direction) const {
  if constexpr (D == 3) {
    if (environment_.image) {
      const auto uv = image_coordinates(environment_.world_to_image.vector(direction));
      // Clamp, because there are no rows beyond the poles.
      const double half = 0.5 / environment_.image->height;
      return environment_.radiance *
             environment_.image->at(uv[0], std::clamp(uv[1], half, 1 - half));
    }
  }
  return environment_.radiance;
}

template <int D>
double EnvironmentSampler<D>::power(const BoundingSphere<D>& bounds) const {
  if (!environment_.image) {
    return average(environment_.radiance) * all_directions<D> * bounds.parallel_area();
  }
  const Texture& image = *environment_.image;
  double sum = 0;
  for (int j = 0; j < image.height; ++j) {
    double row = 0;
    for (int i = 0; i < image.width; ++i) {
      row += average(environment_.radiance *
                     Rgb(image.pixels[static_cast<std::size_t>(j) * image.width + i]));
    }
    sum += row * std::cos(((j + 0.5) / image.height - 0.5) * pi);
  }
  return sum * 2 * pi * pi / (static_cast<double>(image.width) * image.height) *
         bounds.parallel_area();
}

template <int D>
double EnvironmentSampler<D>::largest_flux(const BoundingSphere<D>& bounds) const {
  if (!environment_.image) {
    return largest(environment_.radiance) * all_directions<D> * bounds.parallel_area();
  }
  // Bound the ratio of radiance to density by that of a pixel to the sum over it and its neighbors.
  // A tighter bound is not worth a search.
  return 3 * 9 * power(bounds);
}

template <int D>
typename EnvironmentSampler<D>::Direction EnvironmentSampler<D>::sample_image(
    const std::array<double, 2>& u) const {
  if constexpr (D == 3) {
    const Texture& image = *environment_.image;
    const auto row = rows_.pick(u[1]);
    const auto column = columns_[row.index].pick(u[0]);
    const Vec3 d = image_direction((static_cast<double>(column.index) + column.rest) / image.width,
                                   (static_cast<double>(row.index) + row.rest) / image.height);
    const Vec<D> direction = image_to_world_.vector(d).normalized();
    return {direction, image_density(direction)};
  } else {
    return {Vec<D>(0.0), 0};
  }
}

template <int D>
double EnvironmentSampler<D>::image_density(const Vec<D>& direction) const {
  if constexpr (D == 3) {
    const Texture& image = *environment_.image;
    const auto uv = image_coordinates(environment_.world_to_image.vector(direction));
    const int i = std::clamp(static_cast<int>(uv[0] * image.width), 0, image.width - 1);
    const int j = std::clamp(static_cast<int>(uv[1] * image.height), 0, image.height - 1);
    const double probability = rows_.probability(j) * columns_[j].probability(i);
    const double sine = std::cos((uv[1] - 0.5) * pi);
    if (!(sine > 0)) return 0;
    return probability * image.width * image.height / (2 * pi * pi * sine);
  } else {
    static_cast<void>(direction);
    return 0;
  }
}

template <int D>
LightSample<D> EnvironmentSampler<D>::sample(const Vec<D>& normal,
                                             const std::array<double, 2>& u) const {
  LightSample<D> s;
  s.infinite = true;
  const auto cosine_density = [&](const Vec<D>& d) {
    return std::max(0.0, d.dot(normal)) / projected_hemisphere<D>;
  };
  double density;
  if (!environment_.image) {
    s.direction = sample_cosine_hemisphere<D>(normal, u);
    density = cosine_density(s.direction);
  } else {
    const bool by_cosine = u[0] < 0.5;
    const std::array<double, 2> rest{by_cosine ? 2 * u[0] : 2 * u[0] - 1, u[1]};
    s.direction =
        by_cosine ? sample_cosine_hemisphere<D>(normal, rest) : sample_image(rest).direction;
    density = 0.5 * (cosine_density(s.direction) + image_density(s.direction));
  }
  if (density > 0) s.radiance = radiance(s.direction) / static_cast<Real>(density);
  return s;
}

template <int D>
typename EnvironmentSampler<D>::Direction EnvironmentSampler<D>::sample_any(
    const std::array<double, 2>& u) const {
  if (environment_.image) return sample_image(u);
  Vec<D> axis(0.0);
  axis[0] = 1;
  return {sample_cone<D>(axis, 2, u), 1 / all_directions<D>};
}

template <int D>
LightSource<D> EnvironmentSampler<D>::source(const std::array<double, 2>& u) const {
  const Direction from = sample_any(u);
  LightSource<D> s;
  s.infinite = true;
  s.direction = -from.direction;
  if (from.density > 0) s.amount = radiance(from.direction) / static_cast<Real>(from.density);
  return s;
}

template <int D>
EmittedPhoton<D> EnvironmentSampler<D>::emit(const BoundingSphere<D>& bounds,
                                             const std::array<double, 2>& u_position,
                                             const std::array<double, 2>& u_direction) const {
  const Direction from = sample_any(u_direction);
  const double weight = from.density > 0 ? bounds.parallel_area() / from.density : 0;
  return {bounds.parallel_origin(-from.direction, u_position), -from.direction,
          radiance(from.direction) * static_cast<Real>(weight)};
}

template class EnvironmentSampler<2>;
template class EnvironmentSampler<3>;

}  // namespace leaflight
