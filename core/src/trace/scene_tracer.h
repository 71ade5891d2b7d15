// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "trace/isosurface_ray.h"
#include "trace/walls.h"

namespace leaflight {

enum class HitKind { none, isosurface, walls };

template <int D>
struct Hit {
  HitKind kind = HitKind::none;
  int volume = 0;  // whose isosurface it is
  IsosurfaceHit<D> isosurface;
  WallHit walls;
};

// Where on an isosurface a point is.
template <int D>
struct IsosurfacePlace {
  int volume;
  CellPoint<D> cell_point;
  bool back;               // seen from the side of higher values
  double gradient_length;  // |grad c| in the frame, the coarea measure dA dc / dV
};

// A point of an isosurface or of the walls, seen from one of its sides.
template <int D>
struct SurfacePoint {
  // In the order of HitKind.
  std::variant<std::monostate, IsosurfacePlace<D>, WallHit> on;
  Scattering scattering = Scattering::diffuse;
  double c = 0;                  // the common isovalue
  Vec<D> position{0.0};          // frame
  Vec<D> geometric_normal{0.0};  // unit, of the traced surface, on the side from which it is seen
  Vec<D> shading_normal{0.0};    // unit, for the cosine; the geometric one on walls
  Rgb albedo{0};
  Rgb emission{0};
  double ior = 1;  // glass only: of the far side against the near one

  HitKind kind() const { return static_cast<HitKind>(on.index()); }
  const IsosurfacePlace<D>& isosurface() const { return std::get<IsosurfacePlace<D>>(on); }
  const WallHit& facet() const { return std::get<WallHit>(on); }
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

// A sphere about everything that rays can hit, in the frame.
template <int D>
struct BoundingSphere {
  Vec<D> centre{0.0};
  double radius = 0;
};

// The isosurfaces that block a way: those of least < c <= greatest. The greatest common isovalue on
// the way is infinite where the walls block it, and just less than the isovalue range where none of
// its isosurfaces does.
// The least one on it is minus infinity in a scene without openings, where every way comes from
// outside of the isosurfaces.
struct BlockingIsovalues {
  double least, greatest;

  bool include(double c) const { return least < c && c <= greatest; }
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
  // Around the volumes and meshes.
  const Box<D>& box() const { return box_; }
  const BoundingSphere<D>& bounds() const { return bounds_; }
  const Walls<D>& walls() const { return walls_; }

  // The point of a volume's isosurface at a cell point, whose common isovalue must be c, seen from
  // the given side. Its kind is none where |grad h| = 0: no isosurface passes there.
  SurfacePoint<D> isosurface_point(int volume, const CellPoint<D>& point, double c,
                                   bool back) const;

  // Whether a point of a volume's isosurface c lies inside another volume's, where nobody sees it.
  // Glass covers nothing.
  bool is_covered(int volume, const Vec<D>& position, double c) const;

  // The point of a facet of the walls, seen from the side of its normal, or from the other.
  SurfacePoint<D> facet_point(int mesh, int facet, double u, double v, bool front, double c) const;

  Hit<D> intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Hit<D> intersect(const Vec<D>& origin, const Vec<D>& direction, double c) const;
  SurfacePoint<D> surface_point(const Hit<D>& hit, const Vec<D>& direction, double c) const;

  // Whether an isosurface or the walls block the way from a surface point to a point of a light, or
  // in a direction without end.
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                const Vec<D>& light_normal) const;
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& direction) const;

  // Which isosurfaces block such a way.
  BlockingIsovalues blocking(const SurfacePoint<D>& from, const Vec<D>& light_point,
                             const Vec<D>& light_normal) const;
  BlockingIsovalues blocking(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  // Whether a way may pass through the isosurfaces' openings: of the scene's only volume.
  bool has_openings() const { return has_openings_; }

 private:
  struct FieldFrame {
    Affine<D> index_to_frame, frame_to_index;
  };
  IsosurfaceRay<D> isosurface_ray(int volume, const SurfacePoint<D>& from,
                                  const Vec<D>& direction) const;
  Vec<D> ray_origin(const SurfacePoint<D>& from) const;
  Hit<D> nearest(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& direction) const;
  bool blocked(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& way,
               double t_max) const;
  BlockingIsovalues blocking(const Vec<D>& origin, const Vec<D>& way, double t_max) const;

  const Scene<D>& scene_;
  Frame<D> frame_;
  std::vector<FieldFrame> fields_;
  std::vector<Mesh<D>> meshes_;
  std::vector<Light<D>> lights_;
  Box<D> box_;
  BoundingSphere<D> bounds_;
  Walls<D> walls_;
  bool has_openings_;
};

}  // namespace leaflight
