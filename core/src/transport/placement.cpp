// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/placement.h"

#include <optional>

#include "base/error.h"
#include "base/low_discrepancy.h"

namespace leaflight {
namespace {

constexpr int rays = 64;

// Returns points slightly inside the corners of a volume's box, and its center.
template <int D>
std::vector<Vec<D>> box_points(const SceneTracer<D>& tracer, int volume) {
  const Field<D>& field = tracer.scene().volumes[volume].field;
  std::vector<Vec<D>> points;
  for (int corner = 0; corner <= (1 << D); ++corner) {
    Vec<D> index;
    for (int a = 0; a < D; ++a) {
      const double share = corner == (1 << D) ? 0.5 : (corner >> a) & 1 ? 0.99 : 0.01;
      index[a] = share * (field.dims[a] - 1);
    }
    points.push_back(tracer.index_to_frame(volume).point(index));
  }
  return points;
}

template <int D>
Vec<D> any_direction(int i) {
  Vec<D> axis(0.0);
  axis[0] = 1;
  return sample_cone<D>(axis, 2, sobol_point(i, 0));
}

template <int D>
bool any_volume_seen(const SceneTracer<D>& tracer, const Vec<D>& from) {
  for (std::size_t v = 0; v < tracer.scene().volumes.size(); ++v) {
    for (const Vec<D>& point : box_points(tracer, static_cast<int>(v))) {
      if (!tracer.mesh_bvh().occluded(from, point - from, 1)) return true;
    }
  }
  return tracer.scene().volumes.empty();
}

// Returns the mesh that rays hit in all directions, or nothing.
template <int D>
std::optional<int> enclosing_mesh(const SceneTracer<D>& tracer, const Vec<D>& from) {
  std::optional<int> mesh;
  for (int i = 0; i < rays; ++i) {
    const auto hit = tracer.mesh_bvh().intersect(from, any_direction<D>(i),
                                                 std::numeric_limits<double>::infinity());
    if (!hit || (mesh && *mesh != hit->mesh)) return std::nullopt;
    mesh = hit->mesh;
  }
  return mesh;
}

template <int D>
void check_lights(const SceneTracer<D>& tracer) {
  for (const Light<D>& light : tracer.lights()) {
    const auto place = std::visit([](const auto& l) { return l.place(); }, light);
    if (!place) continue;
    const std::optional<int> mesh = enclosing_mesh<D>(tracer, *place);
    if (!mesh || any_volume_seen<D>(tracer, *place)) continue;
    const std::string name = std::visit([](const auto& l) { return l.name; }, light);
    throw Error("The light '" + name + "' stands inside the mesh '" + tracer.meshes()[*mesh].name +
                "', which lets none of its light out; move it.");
  }
}

template <int D>
bool overlaps_walls(const SceneTracer<D>& tracer, const std::vector<Vec<D>>& points) {
  Box<D> walls, box;
  for (const Mesh<D>& mesh : tracer.meshes()) {
    for (const auto& vertex : mesh.vertices) walls.extend(Vec<D>(vertex));
  }
  for (const Vec<D>& point : points) box.extend(point);
  return box.overlaps(walls);
}

template <int D>
bool any_light_reaches(const SceneTracer<D>& tracer, const std::vector<Vec<D>>& points) {
  const double far = 4 * tracer.bounds().radius;
  for (const Vec<D>& point : points) {
    for (const Light<D>& light : tracer.lights()) {
      for (int i = 0; i < rays; ++i) {
        const auto u = sobol_point(i, 1);
        const auto sample = std::visit([&](const auto& l) { return l.sample(point, u); }, light);
        if (!(largest(sample.radiance) > 0)) continue;
        const Vec<D> to_light = sample.infinite
                                    ? sample.direction * far
                                    : leave_plane<D>(sample.end, sample.end_normal) - point;
        if (!tracer.mesh_bvh().occluded(point, to_light, 1)) return true;
      }
    }
    for (int i = 0; tracer.scene().environment && i < rays; ++i) {
      if (!tracer.mesh_bvh().occluded(point, any_direction<D>(i), far)) return true;
    }
  }
  return false;
}

template <int D>
bool something_glows(const Scene<D>& scene) {
  for (const Mesh<D>& mesh : scene.meshes) {
    if (largest(mesh.emission) > 0) return true;
  }
  for (const Volume<D>& volume : scene.volumes) {
    if (volume.emission.largest() > 0) return true;
  }
  return false;
}

}  // namespace

template <int D>
void check_placement(const SceneTracer<D>& tracer) {
  if (tracer.meshes().empty()) return;
  check_lights(tracer);
  if (something_glows(tracer.scene())) return;
  for (std::size_t v = 0; v < tracer.scene().volumes.size(); ++v) {
    const std::vector<Vec<D>> points = box_points(tracer, static_cast<int>(v));
    if (overlaps_walls(tracer, points) || any_light_reaches(tracer, points)) continue;
    throw Error("The volume '" + tracer.scene().volumes[v].name +
                "' lies outside the walls, and no light reaches it; move it into them.");
  }
}

template void check_placement<2>(const SceneTracer<2>&);
template void check_placement<3>(const SceneTracer<3>&);

}  // namespace leaflight
