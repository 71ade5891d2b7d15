// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace leaflight {

struct SurroundingsHit {
  double t = 0;
  int mesh = 0;
  int facet = 0;
  double u = 0, v = 0;  // barycentric coordinates of the facet's second and third vertex
};

// Rays against the meshes, through Embree in robust mode; the segments of the plane are extruded to
// rectangles about it. Coordinates are the caller's, in single precision.
template <int D>
class Surroundings {
 public:
  explicit Surroundings(const std::vector<Mesh<D>>& meshes);
  ~Surroundings();
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  std::optional<SurroundingsHit> intersect(const Vec<D>& origin, const Vec<D>& direction,
                                           double t_max) const;
  bool occluded(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace leaflight
