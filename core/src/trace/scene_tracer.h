// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "trace/leaf_ray.h"
#include "trace/surroundings.h"

namespace leaflight {

enum class HitKind { none, leaf, surroundings };

template <int D>
struct Hit {
  HitKind kind = HitKind::none;
  int volume = 0;  // whose leaf it is
  LeafHit<D> leaf;
  SurroundingsHit surroundings;
};

// Where on a leaf a point is.
template <int D>
struct LeafPlace {
  int volume;
  CellPoint<D> cell_point;
  bool above;              // seen from the side of higher values, the inside
  double gradient_length;  // |grad c| in the frame, the coarea measure dA dc / dV
};

// A point of a leaf or of the surroundings, seen from one of its sides.
template <int D>
struct SurfacePoint {
  // In the order of HitKind.
  std::variant<std::monostate, LeafPlace<D>, SurroundingsHit> on;
  Scattering scattering = Scattering::diffuse;
  double c = 0;                  // the leaf coordinate
  Vec<D> position{0.0};          // frame
  Vec<D> geometric_normal{0.0};  // unit, of the traced surface, on the side from which it is seen
  Vec<D> shading_normal{0.0};    // unit, for the cosine; the geometric one on surroundings
  Rgb albedo{0};
  Rgb emission{0};
  double ior = 1;  // glass only: of the far side against the near one

  HitKind kind() const { return static_cast<HitKind>(on.index()); }
  const LeafPlace<D>& leaf() const { return std::get<LeafPlace<D>>(on); }
  const SurroundingsHit& facet() const { return std::get<SurroundingsHit>(on); }
};

// A position is known to a few units in the last place of single precision; moved this far along
// the normal it has certainly left the plane of its triangle (pbrt 3, ch. 3.9).
template <int D>
Vec<D> leave_plane(const Vec<D>& position, const Vec<D>& normal);

// World to frame.
template <int D>
struct Frame {
  Vec<D> centre{0.0};
  double scale = 1;

  explicit Frame(const Scene<D>& scene);
  Vec<D> point(const Vec<D>& p) const { return (p - centre) * scale; }
  // World to index coordinates of a field, and back.
  Affine<D> index_to_frame(const Field<D>& field) const;
};

// A sphere about everything that rays can meet, in the frame.
template <int D>
struct BoundingSphere {
  Vec<D> centre{0.0};
  double radius = 0;
};

// The leaves that block a way: those of least < c <= greatest. The greatest leaf coordinate on the
// way is at least the window's least one, and infinite where the surroundings block the way. The
// least one on it is minus infinity in a scene without openings, where every way comes from outside
// of the leaves.
struct BlockingLeaves {
  double least, greatest;
};

// The scene made ready for rays. All positions are in the frame: world coordinates translated and
// scaled uniformly so that the box about the volumes is centred at 0 with longest side 1, which
// keeps single-precision intersections accurate wherever the scene stands. Radiance does not depend
// on it.
template <int D>
class SceneTracer {
 public:
  explicit SceneTracer(const Scene<D>& scene);

  const Scene<D>& scene() const { return scene_; }
  const Frame<D>& frame() const { return frame_; }
  const std::vector<Mesh<D>>& meshes() const { return meshes_; }   // frame
  const std::vector<Light<D>>& lights() const { return lights_; }  // frame
  const Affine<D>& index_to_frame(int volume) const { return fields_[volume].index_to_frame; }
  const BoundingSphere<D>& bounds() const { return bounds_; }
  const Surroundings<D>& surroundings() const { return surroundings_; }

  // The point of a volume's leaf at a cell point, whose leaf coordinate must be c, seen from the
  // given side. Its kind is none where |grad h| = 0: no leaf passes there.
  SurfacePoint<D> leaf_point(int volume, const CellPoint<D>& point, double c, bool above) const;

  // Whether a point of a volume's leaf c lies inside another volume's, where nobody sees it. Glass
  // covers nothing.
  bool is_covered(int volume, const Vec<D>& position, double c) const;

  // The point of a facet of the surroundings, seen from the side of its normal, or from the other.
  SurfacePoint<D> facet_point(int mesh, int facet, double u, double v, bool front, double c) const;

  Hit<D> intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Hit<D> intersect(const Vec<D>& origin, const Vec<D>& direction, double c) const;
  SurfacePoint<D> surface_point(const Hit<D>& hit, const Vec<D>& direction, double c) const;

  // Whether a leaf or the surroundings block the way from a surface point to a point of a light, or
  // in a direction without end.
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                const Vec<D>& light_normal) const;
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& direction) const;

  // Which leaves block such a way.
  BlockingLeaves blocking(const SurfacePoint<D>& from, const Vec<D>& light_point,
                          const Vec<D>& light_normal) const;
  BlockingLeaves blocking(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  // Whether a way may pass through the leaves' openings: of the scene's only volume.
  bool has_openings() const { return has_openings_; }

 private:
  struct FieldFrame {
    Affine<D> index_to_frame, frame_to_index;
  };
  LeafRay<D> leaf_ray(int volume, const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Vec<D> ray_origin(const SurfacePoint<D>& from) const;
  Hit<D> nearest(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& direction) const;
  bool blocked(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& way,
               double t_max) const;
  BlockingLeaves blocking(const Vec<D>& origin, const Vec<D>& way, double t_max) const;

  const Scene<D>& scene_;
  Frame<D> frame_;
  std::vector<FieldFrame> fields_;
  std::vector<Mesh<D>> meshes_;
  std::vector<Light<D>> lights_;
  BoundingSphere<D> bounds_;
  Surroundings<D> surroundings_;
  bool has_openings_;
};

}  // namespace leaflight
