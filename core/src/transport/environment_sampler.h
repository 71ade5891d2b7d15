// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/discrete_distribution.h"
#include "scene/scene.h"

namespace leaflight {

// The environment light. An image is sampled in proportion to its brightness.
template <int D>
class EnvironmentSampler {
 public:
  explicit EnvironmentSampler(const Environment<D>& environment);

  Rgb radiance(const Vec<D>& direction) const;  // from a unit direction
  double power(const BoundingSphere<D>& bounds) const;
  double largest_flux(const BoundingSphere<D>& bounds) const;

  // Samples a direction. Half of the samples follow the image, half the cosine to the unit normal.
  // They are combined by the one-sample model with the balance heuristic (Veach and Guibas 1995). A
  // constant environment is sampled by the cosine.
  LightSample<D> sample(const Vec<D>& normal, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(const BoundingSphere<D>& bounds, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  // Samples a direction by the image's brightness, or uniformly if there is no image.
  LightSource<D> source(const std::array<double, 2>& u) const;

 private:
  struct Direction {
    Vec<D> direction;
    double density;  // density per solid angle, or per angle in 2D
  };
  Direction sample_any(const std::array<double, 2>& u) const;
  Direction sample_image(const std::array<double, 2>& u) const;
  double image_density(const Vec<D>& direction) const;

  const Environment<D>& environment_;
  Affine<D> image_to_world_;
  DiscreteDistribution rows_;
  std::vector<DiscreteDistribution> columns_;  // one per row
};

}  // namespace leaflight
