// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/trace/leaf_ray.h"
#include "leaflight/trace/surroundings.h"

namespace leaflight {

enum class HitKind { none, leaf, surroundings };

template <int D>
struct Hit {
  HitKind kind = HitKind::none;
  LeafHit<D> leaf;
  SurroundingsHit surroundings;
};

// A point of a leaf or of the surroundings, seen from one of its sides.
template <int D>
struct SurfacePoint {
  HitKind kind = HitKind::none;
  double isovalue = 0;
  Vec<D> position{0.0};          // frame
  Vec<D> geometric_normal{0.0};  // unit, of the traced surface, on the side from which it is seen
  Vec<D> shading_normal{0.0};    // unit, for the cosine; the geometric one on surroundings
  Rgb albedo{0};
  CellPoint<D> cell_point;     // leaf only
  bool above = false;          // leaf only: seen from the side h >= c, the inside
  double gradient_length = 0;  // leaf only: |grad h| in the frame, the coarea measure dA dc / dV
};

// A position is known to a few units in the last place of single precision; moved this far along
// the normal it has certainly left the plane of its triangle (pbrt 3, ch. 3.9).
template <int D>
Vec<D> leave_plane(const Vec<D>& position, const Vec<D>& normal);

// The scene made ready for rays. All positions are in the frame: world coordinates translated and
// scaled uniformly so that the field's bounding box is centred at 0 with longest side 1, which
// keeps single-precision intersections accurate wherever the scene stands. Radiance does not depend
// on it.
template <int D>
class SceneTracer {
 public:
  explicit SceneTracer(const Scene<D>& scene);

  const Scene<D>& scene() const { return scene_; }
  const std::vector<Mesh<D>>& meshes() const { return meshes_; }            // frame
  const std::vector<RectangleLight<D>>& lights() const { return lights_; }  // frame
  const Affine<D>& index_to_frame() const { return index_to_frame_; }

  // The leaf point at a cell point, on the leaf of its own value h, seen from the given side.
  // Its kind is none where |grad h| = 0: no leaf passes there.
  SurfacePoint<D> leaf_point(const CellPoint<D>& point, double isovalue, bool above) const;

  Hit<D> intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Hit<D> intersect(const Vec<D>& origin, const Vec<D>& direction, double isovalue) const;
  SurfacePoint<D> surface_point(const Hit<D>& hit, const Vec<D>& direction, double isovalue) const;

  // Whether a leaf or the surroundings block the way from a surface point to a point of a light.
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                const Vec<D>& light_normal) const;

 private:
  LeafRay<D> leaf_ray(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Hit<D> nearest(const LeafRay<D>& ray, const Vec<D>& origin, const Vec<D>& direction) const;

  const Scene<D>& scene_;
  Affine<D> index_to_frame_, frame_to_index_;
  std::vector<Mesh<D>> meshes_;
  std::vector<RectangleLight<D>> lights_;
  Surroundings<D> surroundings_;
};

}  // namespace leaflight
