// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "leaflight/scene/scene.h"

namespace leaflight {

struct SurroundingsHit {
  double t = 0;
  int mesh = 0;
  int triangle = 0;
  double u = 0, v = 0;  // barycentric coordinates of the triangle's second and third vertex
};

// Rays against the triangle meshes, through Embree in robust mode. Coordinates are the caller's,
// in single precision.
class Surroundings {
 public:
  explicit Surroundings(const std::vector<Mesh>& meshes);
  ~Surroundings();
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  std::optional<SurroundingsHit> intersect(const Vec3& origin, const Vec3& direction,
                                           double t_max) const;
  bool occluded(const Vec3& origin, const Vec3& direction, double t_max) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace leaflight
