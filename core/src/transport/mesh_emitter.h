// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/discrete_distribution.h"
#include "scene/scene.h"

namespace leaflight {

// The emission of a mesh of the walls, from both sides of its faces.
template <int D>
class MeshEmitter {
 public:
  explicit MeshEmitter(const Mesh<D>& mesh);  // in the frame; must outlive the emitter

  const Rgb& radiance() const { return mesh_->emission; }
  double area() const { return by_area_.total(); }
  // Returns the power of both sides, averaged over the channels.
  double power() const { return 2 * projected_hemisphere<D> * area() * average(radiance()); }

  // `choice` in [0,1) chooses a face in proportion to its area, and in emit() also the side.
  LightSample<D> sample(const Vec<D>& from, double choice, const std::array<double, 2>& u) const;
  EmittedPhoton<D> emit(double choice, const std::array<double, 2>& u_position,
                        const std::array<double, 2>& u_direction) const;
  LightSource<D> source(double choice, const std::array<double, 2>& u) const;

 private:
  struct PointOn {
    Vec<D> position, normal;
  };
  PointOn point(double choice, const std::array<double, 2>& u) const;

  const Mesh<D>* mesh_;
  DiscreteDistribution by_area_;  // over the faces
};

}  // namespace leaflight
