// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include "trace/isosurface_ray.h"
#include "trace/mesh_bvh.h"

namespace leaflight {

enum class HitKind { none, isosurface, mesh };

template <int D>
struct Hit {
  HitKind kind = HitKind::none;
  int volume = 0;  // number of the volume whose isosurface it hits
  IsosurfaceHit<D> isosurface;
  MeshHit on_mesh;
};

// A position on an isosurface.
template <int D>
struct IsosurfacePlace {
  int volume;
  CellPoint<D> cell_point;
  bool back;               // seen from the side of higher values
  double gradient_length;  // |grad c| in the frame, the coarea measure dA dc / dV
};

// A point on an isosurface or a wall, seen from one of its sides.
template <int D>
struct SurfacePoint {
  // The alternatives are in the order of HitKind.
  std::variant<std::monostate, IsosurfacePlace<D>, MeshHit> on;
  Scattering scattering = Scattering::diffuse;
  double c = 0;                  // common isovalue
  Vec<D> position{0.0};          // frame
  Vec<D> geometric_normal{0.0};  // unit, of the traced surface, on the visible side
  Vec<D> shading_normal{0.0};    // unit, for the cosine; equals the geometric one on walls
  Rgb albedo{0};
  Rgb emission{0};
  double ior = 1;  // glass only: index of the far side over that of the near side

  HitKind kind() const { return static_cast<HitKind>(on.index()); }
  const IsosurfacePlace<D>& isosurface() const { return std::get<IsosurfacePlace<D>>(on); }
  const MeshHit& facet() const { return std::get<MeshHit>(on); }
};

// The transform from world coordinates to the frame.
template <int D>
struct Frame {
  Vec<D> center{0.0};
  double scale = 1;

  explicit Frame(const Scene<D>& scene);
  Vec<D> point(const Vec<D>& p) const { return (p - center) * scale; }
  // Returns the transform from index coordinates of a field to the frame.
  Affine<D> index_to_frame(const Field<D>& field) const;
};

// The isovalues whose isosurfaces block a shadow ray: least < c <= greatest. It has an infinite
// `greatest` if walls block the ray. It is just below the isovalue range if none of its isosurfaces
// blocks the ray. In a scene without openings, every ray starts outside the isosurfaces, and
// `least` is minus infinity.
struct BlockingIsovalues {
  double least, greatest;

  bool include(double c) const { return least < c && c <= greatest; }
};

// A scene prepared for rays. Positions are in the frame, a uniform scaling and translation of world
// coordinates. The box around the volumes is centered at 0 with longest side 1. So single-precision
// intersections are accurate anywhere in the world. Radiance is invariant.
template <int D>
class SceneTracer {
 public:
  explicit SceneTracer(const Scene<D>& scene);

  const Scene<D>& scene() const { return scene_; }
  const Frame<D>& frame() const { return frame_; }
  const std::vector<Mesh<D>>& meshes() const { return meshes_; }   // frame
  const std::vector<Light<D>>& lights() const { return lights_; }  // frame
  const Affine<D>& index_to_frame(int volume) const { return fields_[volume].index_to_frame; }
  // Returns the box around volumes and meshes.
  const Box<D>& box() const { return box_; }
  const BoundingSphere<D>& bounds() const { return bounds_; }
  const MeshBvh<D>& mesh_bvh() const { return mesh_bvh_; }

  // Returns the point of a volume's isosurface at a cell point, seen from the given side. The
  // common isovalue there must be c. Its kind is none if |grad h| = 0.
  SurfacePoint<D> isosurface_point(int volume, const CellPoint<D>& point, double c,
                                   bool back) const;

  // True if another volume's isosurface c encloses a point and hides it. Glass hides nothing.
  bool is_covered(int volume, const Vec<D>& position, double c) const;

  // Returns the point of a wall's facet, seen from the side of its normal if `front`.
  SurfacePoint<D> facet_point(int mesh, int facet, double u, double v, bool front, double c) const;

  Hit<D> intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  Hit<D> intersect(const Vec<D>& origin, const Vec<D>& direction, double c) const;
  SurfacePoint<D> surface_point(const Hit<D>& hit, const Vec<D>& direction, double c) const;

  // True if an isosurface or a wall blocks the segment to a point on a light, or the ray to
  // infinity in a direction.
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                const Vec<D>& light_normal) const;
  bool occluded(const SurfacePoint<D>& from, const Vec<D>& direction) const;

  // Returns the isovalues that block such a segment or ray.
  BlockingIsovalues blocking(const SurfacePoint<D>& from, const Vec<D>& light_point,
                             const Vec<D>& light_normal) const;
  BlockingIsovalues blocking(const SurfacePoint<D>& from, const Vec<D>& direction) const;
  // True if light may pass through openings of the isosurfaces, which requires a single volume.
  bool has_openings() const { return has_openings_; }

 private:
  struct FieldFrame {
    Affine<D> index_to_frame, frame_to_index;
  };
  IsosurfaceRay<D> isosurface_ray(int volume, const SurfacePoint<D>& from,
                                  const Vec<D>& direction) const;
  Vec<D> ray_origin(const SurfacePoint<D>& from) const;
  Hit<D> nearest(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& direction) const;
  bool blocked(const SurfacePoint<D>& from, const Vec<D>& origin, const Vec<D>& direction,
               double t_max) const;
  BlockingIsovalues blocking(const Vec<D>& origin, const Vec<D>& direction, double t_max) const;

  const Scene<D>& scene_;
  Frame<D> frame_;
  std::vector<FieldFrame> fields_;
  std::vector<Mesh<D>> meshes_;
  std::vector<Light<D>> lights_;
  Box<D> box_;
  BoundingSphere<D> bounds_;
  MeshBvh<D> mesh_bvh_;
  bool has_openings_;
};

}  // namespace leaflight
