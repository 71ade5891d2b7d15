// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/discrete_distribution.h"
#include "transport/lamp_sampling.h"

namespace leaflight {

// Light from all around. An image is sampled in proportion to its brightness.
template <int D>
class EnvironmentSampler {
 public:
  explicit EnvironmentSampler(const Environment<D>& environment);

  Rgb radiance(const Vec<D>& direction) const;  // from a unit direction
  double power(const BoundingSphere<D>& bounds) const;
  double largest_flux(const BoundingSphere<D>& bounds) const;

  // Half of the samples follow the image, half the cosine to the unit normal (Veach and Guibas
  // 1995, one-sample model with the balance heuristic); a constant environment is sampled by the
  // cosine.
  LightSample<D> sample(const Vec<D>& normal, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(const BoundingSphere<D>& bounds, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  // A direction by the image's brightness; a uniform one where there is none.
  LightSource<D> source(const std::array<double, 2>& u) const;

 private:
  struct Direction {
    Vec<D> direction;
    double density;  // per angle
  };
  Direction sample_any(const std::array<double, 2>& u) const;
  Direction sample_image(const std::array<double, 2>& u) const;
  double image_density(const Vec<D>& direction) const;

  const Environment<D>& environment_;
  Affine<D> image_to_world_;
  DiscreteDistribution rows_;
  std::vector<DiscreteDistribution> columns_;  // of each row
};

}  // namespace leaflight
