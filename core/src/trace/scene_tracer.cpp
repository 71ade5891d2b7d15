// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/scene_tracer.h"

#include <cmath>

namespace leaflight {
namespace {

// World to frame.
struct Frame {
  Vec3 centre;
  double scale;

  explicit Frame(const Field<3>& field) {
    Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 index;
      for (int a = 0; a < 3; ++a) index[a] = ((corner >> a) & 1) * (field.dims[a] - 1);
      const Vec3 p = field.index_to_world.point(index);
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
    const Vec3 size = high - low;
    centre = (low + high) * 0.5;
    scale = 1 / std::max(size.x, std::max(size.y, size.z));
  }
  Vec3 point(const Vec3& p) const { return (p - centre) * scale; }
};

std::vector<Mesh> in_frame(std::vector<Mesh> meshes, const Frame& frame) {
  for (Mesh& mesh : meshes) {
    for (auto& v : mesh.vertices) v = Vec<3, float>(frame.point(Vec3(v)));
  }
  return meshes;
}

std::vector<RectangleLight> in_frame(std::vector<RectangleLight> lights, const Frame& frame) {
  for (RectangleLight& light : lights) {
    light.corner = frame.point(light.corner);
    light.edge_u *= frame.scale;
    light.edge_v *= frame.scale;
  }
  return lights;
}

Affine<3> index_to_frame(const Field<3>& field, const Frame& frame) {
  Affine<3> m;
  for (int a = 0; a < 3; ++a) m.column[a] = field.index_to_world.column[a] * frame.scale;
  m.origin = frame.point(field.index_to_world.origin);
  return m;
}

}  // namespace

Vec3 leave_plane(const Vec3& position, const Vec3& normal) {
  const double size = std::abs(position.x) + std::abs(position.y) + std::abs(position.z) + 1;
  return position + normal * (size * 8 * std::numeric_limits<float>::epsilon());
}

SceneTracer::SceneTracer(const Scene& scene)
    : scene_(scene),
      index_to_frame_(leaflight::index_to_frame(scene.field, Frame(scene.field))),
      frame_to_index_(inverse(index_to_frame_)),
      meshes_(in_frame(scene.meshes, Frame(scene.field))),
      lights_(in_frame(scene.lights, Frame(scene.field))),
      surroundings_(meshes_) {}

SurfacePoint SceneTracer::leaf_point(const CellPoint<3>& point, double isovalue, bool above) const {
  SurfacePoint s;
  s.isovalue = isovalue;
  s.position = index_to_frame_.point(point.index_position());
  s.albedo = scene_.leaf_albedo;
  s.cell_point = point;
  s.above = above;
  // The inside is higher, so the outside faces -grad h.
  const double side = above ? 1 : -1;
  const Vec3 geometric = frame_to_index_.pull_back_gradient(
      geometric_gradient(load_corners(scene_.field, point.cell), point.local));
  const Vec3 shading = frame_to_index_.pull_back_gradient(shading_gradient(scene_.field, point));
  const double geometric_length = geometric.length(), shading_length = shading.length();
  if (!(geometric_length > 0)) return s;
  s.kind = HitKind::leaf;
  s.gradient_length = geometric_length;
  s.geometric_normal = geometric * (side / geometric_length);
  s.shading_normal = shading_length > 0 ? shading * (side / shading_length) : s.geometric_normal;
  return s;
}

LeafRay<3> SceneTracer::leaf_ray(const SurfacePoint& from, const Vec3& direction) const {
  LeafRay<3> ray;
  ray.direction = frame_to_index_.vector(direction);
  ray.isovalue = from.isovalue;
  if (from.kind == HitKind::leaf) {
    ray.starts_on_leaf = true;
    ray.starts_above = from.above;
    ray.origin = from.cell_point;
    ray.position = from.cell_point.index_position();
  } else {
    ray.position = frame_to_index_.point(from.position);
  }
  return ray;
}

Hit SceneTracer::nearest(const LeafRay<3>& ray, const Vec3& origin, const Vec3& direction) const {
  Hit hit;
  LeafRay<3> leaf_ray = ray;
  if (const auto found = surroundings_.intersect(origin, direction, ray.t_max)) {
    hit.kind = HitKind::surroundings;
    hit.surroundings = *found;
    leaf_ray.t_max = found->t;
  }
  if (const auto found = leaflight::intersect(scene_.field, leaf_ray)) {
    hit.kind = HitKind::leaf;
    hit.leaf = *found;
  }
  return hit;
}

Hit SceneTracer::intersect(const SurfacePoint& from, const Vec3& direction) const {
  const Vec3 origin = from.kind == HitKind::surroundings
                          ? leave_plane(from.position, from.geometric_normal)
                          : from.position;
  return nearest(leaf_ray(from, direction), origin, direction);
}

Hit SceneTracer::intersect(const Vec3& origin, const Vec3& direction, double isovalue) const {
  SurfacePoint from;
  from.position = origin;
  from.isovalue = isovalue;
  return nearest(leaf_ray(from, direction), origin, direction);
}

SurfacePoint SceneTracer::surface_point(const Hit& hit, const Vec3& direction,
                                        double isovalue) const {
  if (hit.kind == HitKind::leaf) {
    SurfacePoint s = leaf_point(hit.leaf.point, isovalue, hit.leaf.from_above);
    if (s.kind == HitKind::none) {
      // A crossing in a place without a gradient, as on the face of a plateau: face the ray.
      s.kind = HitKind::leaf;
      s.geometric_normal = s.shading_normal = -direction.normalized();
    }
    return s;
  }
  SurfacePoint s;
  if (hit.kind == HitKind::none) return s;
  const Mesh& mesh = meshes_[hit.surroundings.mesh];
  const auto& triangle = mesh.triangles[hit.surroundings.triangle];
  const Vec3 a(mesh.vertices[triangle[0]]);
  const Vec3 ab = Vec3(mesh.vertices[triangle[1]]) - a, ac = Vec3(mesh.vertices[triangle[2]]) - a;
  s.kind = HitKind::surroundings;
  s.isovalue = isovalue;
  s.position = a + ab * hit.surroundings.u + ac * hit.surroundings.v;
  s.geometric_normal = ab.cross(ac).normalized();
  if (s.geometric_normal.dot(direction) > 0) s.geometric_normal = -s.geometric_normal;
  s.shading_normal = s.geometric_normal;
  s.albedo = mesh.albedo;
  return s;
}

bool SceneTracer::occluded(const SurfacePoint& from, const Vec3& light_point,
                           const Vec3& light_normal) const {
  const Vec3 origin = from.kind == HitKind::surroundings
                          ? leave_plane(from.position, from.geometric_normal)
                          : from.position;
  const Vec3 way = leave_plane(light_point, light_normal) - origin;
  // The direction is the whole way, so the segment ends at t = 1.
  if (surroundings_.occluded(origin, way, 1)) return true;
  LeafRay<3> ray = leaf_ray(from, way);
  ray.t_max = 1;
  return leaflight::intersect(scene_.field, ray).has_value();
}

}  // namespace leaflight
