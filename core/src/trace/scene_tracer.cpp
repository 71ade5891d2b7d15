// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/scene_tracer.h"

#include <cmath>
#include <limits>

#include "base/sampling.h"
#include "field/shading_gradient.h"
#include "scene/open_isosurfaces.h"
#include "trace/greatest_value.h"

namespace leaflight {
namespace {

// Returns the next smaller number in single precision, in which many isovalues are stored.
double just_less(double c) {
  return std::nextafter(static_cast<float>(c), -std::numeric_limits<float>::infinity());
}

// Returns the box around the volumes, or around the meshes if there are no volumes.
template <int D>
Box<D> framed_box(const Scene<D>& scene) {
  Box<D> box;
  for (const Volume<D>& volume : scene.volumes) box.extend(world_box(volume.field));
  if (!scene.volumes.empty()) return box;
  for (const Mesh<D>& mesh : scene.meshes) {
    for (const auto& v : mesh.vertices) box.extend(Vec<D>(v));
  }
  return box;
}

template <int D>
std::vector<Mesh<D>> in_frame(std::vector<Mesh<D>> meshes, const Frame<D>& frame) {
  for (Mesh<D>& mesh : meshes) {
    for (auto& v : mesh.vertices) v = Vec<D, float>(frame.point(Vec<D>(v)));
  }
  return meshes;
}

template <int D>
std::vector<Light<D>> in_frame(std::vector<Light<D>> lights, const Frame<D>& frame) {
  for (Light<D>& light : lights) {
    std::visit([&](auto& l) { l.to_frame(frame.center, frame.scale); }, light);
  }
  return lights;
}

template <int D>
Box<D> box_of(const Scene<D>& scene, const Frame<D>& frame, const std::vector<Mesh<D>>& meshes) {
  Box<D> box;
  for (const Volume<D>& volume : scene.volumes) {
    const Box<D> volume_box = world_box(volume.field);
    box.extend({frame.point(volume_box.low), frame.point(volume_box.high)});
  }
  for (const Mesh<D>& mesh : meshes) {
    for (const auto& v : mesh.vertices) box.extend(Vec<D>(v));
  }
  return box;
}

template <int D>
BoundingSphere<D> sphere_around(const Box<D>& box) {
  return {(box.low + box.high) * 0.5, 0.5 * (box.high - box.low).length() * (1 + 1e-6)};
}

}  // namespace

template <int D>
Frame<D>::Frame(const Scene<D>& scene) {
  const Box<D> box = framed_box(scene);
  center = (box.low + box.high) * 0.5;
  scale = 1 / box.longest_side();
}

template <int D>
Affine<D> Frame<D>::index_to_frame(const Field<D>& field) const {
  Affine<D> m;
  for (int a = 0; a < D; ++a) m.column[a] = field.index_to_world.column[a] * scale;
  m.origin = point(field.index_to_world.origin);
  return m;
}

template <int D>
SceneTracer<D>::SceneTracer(const Scene<D>& scene)
    : scene_(scene),
      frame_(scene),
      meshes_(in_frame(scene.meshes, frame_)),
      lights_(in_frame(scene.lights, frame_)),
      box_(box_of(scene, frame_, meshes_)),
      bounds_(sphere_around(box_)),
      mesh_bvh_(meshes_),
      has_openings_(scene.volumes.size() == 1 &&
                    isosurfaces_are_open(scene.volumes[0], scene.isovalue_range)) {
  for (const Volume<D>& volume : scene.volumes) {
    const Affine<D> index_to_frame = frame_.index_to_frame(volume.field);
    fields_.push_back({index_to_frame, inverse(index_to_frame)});
  }
}

template <int D>
SurfacePoint<D> SceneTracer<D>::isosurface_point(int volume, const CellPoint<D>& point, double c,
                                                 bool back) const {
  const Volume<D>& scene_volume = scene_.volumes[volume];
  const FieldFrame& frames = fields_[volume];
  SurfacePoint<D> s;
  s.scattering = scene_volume.scattering;
  s.c = c;
  s.position = frames.index_to_frame.point(point.index_position());
  s.albedo = scene_volume.albedo.at(c);
  if (scene_volume.texture) s.albedo *= scene_volume.texture->at(point.index_position());
  s.emission = scene_volume.emission.at(c);
  s.ior = back ? 1 / scene_volume.ior : scene_volume.ior;
  // The outside has lower values, so its normal is -grad h.
  const double side = back ? 1 : -1;
  const Vec<D> geometric = frames.frame_to_index.pull_back_gradient(
      geometric_gradient(load_corners(scene_volume.field, point.cell), point.local));
  const Vec<D> shading =
      frames.frame_to_index.pull_back_gradient(shading_gradient(scene_volume.field, point));
  const double geometric_length = geometric.length(), shading_length = shading.length();
  if (!(geometric_length > 0)) return s;
  s.on = IsosurfacePlace<D>{volume, point, back, geometric_length / scene_volume.scale};
  s.geometric_normal = geometric * (side / geometric_length);
  s.shading_normal = shading_length > 0 ? shading * (side / shading_length) : s.geometric_normal;
  return s;
}

template <int D>
bool SceneTracer<D>::is_covered(int volume, const Vec<D>& position, double c) const {
  for (std::size_t v = 0; v < fields_.size(); ++v) {
    const Volume<D>& other = scene_.volumes[v];
    if (static_cast<int>(v) == volume || other.scattering == Scattering::glass) continue;
    const double h = value_at(other.field, fields_[v].frame_to_index.point(position));
    if (h >= other.isovalue(c)) return true;
  }
  return false;
}

template <int D>
SurfacePoint<D> SceneTracer<D>::facet_point(int mesh_index, int facet, double u, double v,
                                            bool front, double c) const {
  const Mesh<D>& mesh = meshes_[mesh_index];
  const FacetFrame<D> frame(mesh, facet);
  SurfacePoint<D> s;
  s.on = MeshHit{0, mesh_index, facet, u, v};
  s.scattering = mesh.scattering;
  s.c = c;
  s.position = frame.point(u, v);
  s.geometric_normal = front ? frame.normal() : -frame.normal();
  s.shading_normal = s.geometric_normal;
  s.albedo = mesh.albedo_at(facet, u, v);
  s.emission = mesh.emission;
  s.ior = front ? mesh.ior : 1 / mesh.ior;
  return s;
}

template <int D>
IsosurfaceRay<D> SceneTracer<D>::isosurface_ray(int volume, const SurfacePoint<D>& from,
                                                const Vec<D>& direction) const {
  IsosurfaceRay<D> ray;
  ray.direction = fields_[volume].frame_to_index.vector(direction);
  ray.isovalue = scene_.volumes[volume].isovalue(from.c);
  const auto* place = std::get_if<IsosurfacePlace<D>>(&from.on);
  if (place && place->volume == volume) {
    ray.starts_on_isosurface = true;
    ray.starts_above = place->back;
    ray.origin = place->cell_point;
    ray.position = place->cell_point.index_position();
  } else {
    ray.position = fields_[volume].frame_to_index.point(from.position);
  }
  return ray;
}

template <int D>
Vec<D> SceneTracer<D>::ray_origin(const SurfacePoint<D>& from) const {
  return from.kind() == HitKind::mesh ? leave_plane<D>(from.position, from.geometric_normal)
                                      : from.position;
}

template <int D>
Hit<D> SceneTracer<D>::nearest(const SurfacePoint<D>& from, const Vec<D>& origin,
                               const Vec<D>& direction) const {
  Hit<D> hit;
  double t_max = std::numeric_limits<double>::infinity();
  if (const auto found = mesh_bvh_.intersect(origin, direction, t_max)) {
    hit.kind = HitKind::mesh;
    hit.on_mesh = *found;
    t_max = found->t;
  }
  for (int v = 0; v < static_cast<int>(fields_.size()); ++v) {
    IsosurfaceRay<D> ray = isosurface_ray(v, from, direction);
    ray.t_max = t_max;
    if (const auto found = leaflight::intersect(scene_.volumes[v].field, ray)) {
      hit.kind = HitKind::isosurface;
      hit.volume = v;
      hit.isosurface = *found;
      t_max = found->t;
    }
  }
  return hit;
}

template <int D>
Hit<D> SceneTracer<D>::intersect(const SurfacePoint<D>& from, const Vec<D>& direction) const {
  return nearest(from, ray_origin(from), direction);
}

template <int D>
Hit<D> SceneTracer<D>::intersect(const Vec<D>& origin, const Vec<D>& direction, double c) const {
  SurfacePoint<D> from;
  from.position = origin;
  from.c = c;
  return nearest(from, origin, direction);
}

template <int D>
SurfacePoint<D> SceneTracer<D>::surface_point(const Hit<D>& hit, const Vec<D>& direction,
                                              double c) const {
  if (hit.kind == HitKind::isosurface) {
    SurfacePoint<D> s =
        isosurface_point(hit.volume, hit.isosurface.point, c, hit.isosurface.from_above);
    if (s.kind() == HitKind::none) {
      // A crossing without a gradient, as on the face of a plateau, faces the ray.
      s.on = IsosurfacePlace<D>{hit.volume, hit.isosurface.point, hit.isosurface.from_above, 0};
      s.geometric_normal = s.shading_normal = -direction.normalized();
    }
    return s;
  }
  if (hit.kind == HitKind::none) return {};
  const MeshHit& on = hit.on_mesh;
  const FacetFrame<D> facet(meshes_[on.mesh], on.facet);
  const bool front = !(facet.normal().dot(direction) > 0);
  return facet_point(on.mesh, on.facet, on.u, on.v, front, c);
}

template <int D>
bool SceneTracer<D>::blocked(const SurfacePoint<D>& from, const Vec<D>& origin,
                             const Vec<D>& direction, double t_max) const {
  for (int v = 0; v < static_cast<int>(fields_.size()); ++v) {
    IsosurfaceRay<D> ray = isosurface_ray(v, from, direction);
    ray.t_max = t_max;
    if (leaflight::occluded(scene_.volumes[v].field, ray)) return true;
  }
  return mesh_bvh_.occluded(origin, direction, t_max);
}

template <int D>
bool SceneTracer<D>::occluded(const SurfacePoint<D>& from, const Vec<D>& light_point,
                              const Vec<D>& light_normal) const {
  const Vec<D> origin = ray_origin(from);
  // The direction is the whole segment, so t = 1 at its end.
  return blocked(from, origin, leave_plane<D>(light_point, light_normal) - origin, 1);
}

template <int D>
bool SceneTracer<D>::occluded(const SurfacePoint<D>& from, const Vec<D>& direction) const {
  return blocked(from, ray_origin(from), direction, std::numeric_limits<double>::infinity());
}

template <int D>
BlockingIsovalues SceneTracer<D>::blocking(const Vec<D>& origin, const Vec<D>& direction,
                                           double t_max) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (mesh_bvh_.occluded(origin, direction, t_max)) return {-infinity, infinity};
  const double nothing = just_less(scene_.isovalue_range.min);
  double c = nothing;
  for (std::size_t v = 0; v < fields_.size(); ++v) {
    const Volume<D>& volume = scene_.volumes[v];
    const Affine<D>& to_index = fields_[v].frame_to_index;
    c = std::max(c, volume.common_isovalue(greatest_value(volume.field, to_index.point(origin),
                                                          to_index.vector(direction), t_max,
                                                          volume.isovalue(c))));
  }
  if (!has_openings_ || c == nothing) return {-infinity, c};
  const Volume<D>& volume = scene_.volumes[0];
  const Affine<D>& to_index = fields_[0].frame_to_index;
  const double least = least_value(volume.field, to_index.point(origin), to_index.vector(direction),
                                   t_max, volume.isovalue(c));
  return {volume.common_isovalue(least), c};
}

template <int D>
BlockingIsovalues SceneTracer<D>::blocking(const SurfacePoint<D>& from, const Vec<D>& light_point,
                                           const Vec<D>& light_normal) const {
  const Vec<D> origin = ray_origin(from);
  return blocking(origin, leave_plane<D>(light_point, light_normal) - origin, 1);
}

template <int D>
BlockingIsovalues SceneTracer<D>::blocking(const SurfacePoint<D>& from,
                                           const Vec<D>& direction) const {
  return blocking(ray_origin(from), direction, std::numeric_limits<double>::infinity());
}

template struct Frame<2>;
template struct Frame<3>;
template class SceneTracer<2>;
template class SceneTracer<3>;

}  // namespace leaflight
