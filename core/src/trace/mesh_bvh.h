// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace leaflight {

struct MeshHit {
  double t = 0;
  int mesh = 0;
  int facet = 0;
  double u = 0, v = 0;  // barycentric coordinates of the facet's second and third vertex
};

// Ray intersections with the meshes by Embree in robust mode. In 2D, segments become rectangles
// across the plane. Coordinates are the caller's, in single precision.
template <int D>
class MeshBvh {
 public:
  explicit MeshBvh(const std::vector<Mesh<D>>& meshes);
  ~MeshBvh();
  MeshBvh(const MeshBvh&) = delete;
  MeshBvh& operator=(const MeshBvh&) = delete;

  std::optional<MeshHit> intersect(const Vec<D>& origin, const Vec<D>& direction,
                                   double t_max) const;
  bool occluded(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace leaflight
