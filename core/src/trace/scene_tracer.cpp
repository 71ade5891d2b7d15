// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/scene_tracer.h"

#include <cmath>

namespace leaflight {
namespace {

// World to frame.
template <int D>
struct Frame {
  Vec<D> centre;
  double scale;

  explicit Frame(const Field<D>& field) {
    const auto [low, high] = world_box(field);
    double size = 0;
    for (int a = 0; a < D; ++a) size = std::max(size, high[a] - low[a]);
    centre = (low + high) * 0.5;
    scale = 1 / size;
  }
  Vec<D> point(const Vec<D>& p) const { return (p - centre) * scale; }
};

template <int D>
std::vector<Mesh<D>> in_frame(std::vector<Mesh<D>> meshes, const Frame<D>& frame) {
  for (Mesh<D>& mesh : meshes) {
    for (auto& v : mesh.vertices) v = Vec<D, float>(frame.point(Vec<D>(v)));
  }
  return meshes;
}

template <int D>
std::vector<RectangleLight<D>> in_frame(std::vector<RectangleLight<D>> lights,
                                        const Frame<D>& frame) {
  for (RectangleLight<D>& light : lights) {
    light.corner = frame.point(light.corner);
    for (Vec<D>& edge : light.edges) edge *= frame.scale;
  }
  return lights;
}

template <int D>
Affine<D> index_to_frame(const Field<D>& field, const Frame<D>& frame) {
  Affine<D> m;
  for (int a = 0; a < D; ++a) m.column[a] = field.index_to_world.column[a] * frame.scale;
  m.origin = frame.point(field.index_to_world.origin);
  return m;
}

}  // namespace

template <int D>
Vec<D> leave_plane(const Vec<D>& position, const Vec<D>& normal) {
  double size = 1;
  for (int a = 0; a < D; ++a) size += std::abs(position[a]);
  return position + normal * (size * 8 * std::numeric_limits<float>::epsilon());
}

template <int D>
SceneTracer<D>::SceneTracer(const Scene<D>& scene)
    : scene_(scene),
      index_to_frame_(leaflight::index_to_frame(scene.field, Frame<D>(scene.field))),
      frame_to_index_(inverse(index_to_frame_)),
      meshes_(in_frame(scene.meshes, Frame<D>(scene.field))),
      lights_(in_frame(scene.lights, Frame<D>(scene.field))),
      surroundings_(meshes_) {}

template <int D>
SurfacePoint<D> SceneTracer<D>::leaf_point(const CellPoint<D>& point, double isovalue,
                                           bool above) const {
  SurfacePoint<D> s;
  s.isovalue = isovalue;
  s.position = index_to_frame_.point(point.index_position());
  s.albedo = scene_.leaf_albedo;
  s.cell_point = point;
  s.above = above;
  // The inside is higher, so the outside faces -grad h.
  const double side = above ? 1 : -1;
  const Vec<D> geometric = frame_to_index_.pull_back_gradient(
      geometric_gradient(load_corners(scene_.field, point.cell), point.local));
  const Vec<D> shading = frame_to_index_.pull_back_gradient(shading_gradient(scene_.field, point));
  const double geometric_length = geometric.length(), shading_length = shading.length();
  if (!(geometric_length > 0)) return s;
  s.kind = HitKind::leaf;
  s.gradient_length = geometric_length;
  s.geometric_normal = geometric * (side / geometric_length);
  s.shading_normal = shading_length > 0 ? shading * (side / shading_length) : s.geometric_normal;
  return s;
}

template <int D>
LeafRay<D> SceneTracer<D>::leaf_ray(const SurfacePoint<D>& from, const Vec<D>& direction) const {
  LeafRay<D> ray;
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

template <int D>
Hit<D> SceneTracer<D>::nearest(const LeafRay<D>& ray, const Vec<D>& origin,
                               const Vec<D>& direction) const {
  Hit<D> hit;
  LeafRay<D> leaf_ray = ray;
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

template <int D>
Hit<D> SceneTracer<D>::intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const {
  const Vec<D> origin = from.kind == HitKind::surroundings
                            ? leave_plane<D>(from.position, from.geometric_normal)
                            : from.position;
  return nearest(leaf_ray(from, direction), origin, direction);
}

template <int D>
Hit<D> SceneTracer<D>::intersect(const Vec<D>& origin, const Vec<D>& direction,
                                 double isovalue) const {
  SurfacePoint<D> from;
  from.position = origin;
  from.isovalue = isovalue;
  return nearest(leaf_ray(from, direction), origin, direction);
}

template <int D>
SurfacePoint<D> SceneTracer<D>::surface_point(const Hit<D>& hit, const Vec<D>& direction,
                                              double isovalue) const {
  if (hit.kind == HitKind::leaf) {
    SurfacePoint<D> s = leaf_point(hit.leaf.point, isovalue, hit.leaf.from_above);
    if (s.kind == HitKind::none) {
      // A crossing in a place without a gradient, as on the face of a plateau: face the ray.
      s.kind = HitKind::leaf;
      s.geometric_normal = s.shading_normal = -direction.normalized();
    }
    return s;
  }
  SurfacePoint<D> s;
  if (hit.kind == HitKind::none) return s;
  const Mesh<D>& mesh = meshes_[hit.surroundings.mesh];
  const FacetFrame<D> facet(mesh, hit.surroundings.facet);
  s.kind = HitKind::surroundings;
  s.isovalue = isovalue;
  s.position = facet.point(hit.surroundings.u, hit.surroundings.v);
  s.geometric_normal = facet.normal();
  if (s.geometric_normal.dot(direction) > 0) s.geometric_normal = -s.geometric_normal;
  s.shading_normal = s.geometric_normal;
  s.albedo = mesh.albedo;
  return s;
}

template <int D>
bool SceneTracer<D>::occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                              const Vec<D>& light_normal) const {
  const Vec<D> origin = from.kind == HitKind::surroundings
                            ? leave_plane<D>(from.position, from.geometric_normal)
                            : from.position;
  const Vec<D> way = leave_plane<D>(light_point, light_normal) - origin;
  // The direction is the whole way, so the segment ends at t = 1.
  if (surroundings_.occluded(origin, way, 1)) return true;
  LeafRay<D> ray = leaf_ray(from, way);
  ray.t_max = 1;
  return leaflight::intersect(scene_.field, ray).has_value();
}

template Vec<2> leave_plane<2>(const Vec<2>&, const Vec<2>&);
template Vec<3> leave_plane<3>(const Vec<3>&, const Vec<3>&);
template class SceneTracer<2>;
template class SceneTracer<3>;

}  // namespace leaflight
