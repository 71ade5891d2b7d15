// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/trace/leaf_ray.h"
#include "leaflight/trace/surroundings.h"

namespace leaflight {

enum class HitKind { none, leaf, surroundings };

struct Hit {
  HitKind kind = HitKind::none;
  LeafHit<3> leaf;
  SurroundingsHit surroundings;
};

// A point of a leaf or of the surroundings, seen from one of its sides.
struct SurfacePoint {
  HitKind kind = HitKind::none;
  double isovalue = 0;
  Vec3 position{0.0};          // frame
  Vec3 geometric_normal{0.0};  // unit, of the traced surface, on the side from which it is seen
  Vec3 shading_normal{0.0};    // unit, for the cosine; the geometric one on surroundings
  Rgb albedo{0};
  CellPoint<3> cell_point;     // leaf only
  bool above = false;          // leaf only: seen from the side h >= c, the inside
  double gradient_length = 0;  // leaf only: |grad h| in the frame, the coarea measure dA dc / dV
};

// A position is known to a few units in the last place of single precision; moved this far along
// the normal it has certainly left the plane of its triangle (pbrt 3, ch. 3.9).
Vec3 leave_plane(const Vec3& position, const Vec3& normal);

// The scene made ready for rays. All positions are in the frame: world coordinates translated and
// scaled uniformly so that the field's bounding box is centred at 0 with longest side 1, which
// keeps single-precision intersections accurate wherever the scene stands. Radiance does not depend
// on it.
class SceneTracer {
 public:
  explicit SceneTracer(const Scene& scene);

  const Scene& scene() const { return scene_; }
  const std::vector<Mesh>& meshes() const { return meshes_; }            // frame
  const std::vector<RectangleLight>& lights() const { return lights_; }  // frame
  const Affine<3>& index_to_frame() const { return index_to_frame_; }

  // The leaf point at a cell point, on the leaf of its own value h, seen from the given side.
  // Its kind is none where |grad h| = 0: no leaf passes there.
  SurfacePoint leaf_point(const CellPoint<3>& point, double isovalue, bool above) const;

  Hit intersect(const SurfacePoint& from, const Vec3& direction) const;
  Hit intersect(const Vec3& origin, const Vec3& direction, double isovalue) const;
  SurfacePoint surface_point(const Hit& hit, const Vec3& direction, double isovalue) const;

  // Whether a leaf or the surroundings block the way from a surface point to a point of a light.
  bool occluded(const SurfacePoint& from, const Vec3& light_point, const Vec3& light_normal) const;

 private:
  LeafRay<3> leaf_ray(const SurfacePoint& from, const Vec3& direction) const;
  Hit nearest(const LeafRay<3>& ray, const Vec3& origin, const Vec3& direction) const;

  const Scene& scene_;
  Affine<3> index_to_frame_, frame_to_index_;
  std::vector<Mesh> meshes_;
  std::vector<RectangleLight> lights_;
  Surroundings surroundings_;
};

}  // namespace leaflight
