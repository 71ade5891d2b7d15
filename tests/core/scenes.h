// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/bake.h"
#include "fields.h"

namespace leaflight::test {

// Returns a scene of one volume with nothing around it.
template <int D>
Scene<D> scene_of(Field<D> field, const Rgb& albedo, const IsovalueRange& isovalue_range) {
  Scene<D> scene;
  scene.volumes.resize(1);
  scene.volumes[0].field = std::move(field);
  scene.volumes[0].albedo = albedo;
  scene.isovalue_range = isovalue_range;
  return scene;
}

template <int D>
const Field<D>& field_of(const Scene<D>& scene) {
  return scene.volumes[0].field;
}

// Returns the radiance of the first volume's front at a world position.
template <int D>
Vec<3, float> lookup_world(const Scene<D>& scene, const Baked<D>& baked, const Vec<D>& point) {
  const Field<D>& field = field_of(scene);
  return radiance_at(baked.grids[0], field, field.world_to_index.point(point), false);
}

template <int D>
Baked<D> baked(const Scene<D>& scene, const BakeSettings<D>& settings,
               const BakeHooks<D>& hooks = {}) {
  Progress progress;
  return bake<D>(scene, settings, progress, hooks);
}

inline ReferenceSettings reference_settings(double c, int samples, std::uint64_t seed) {
  ReferenceSettings settings;
  settings.c = c;
  settings.samples = samples;
  settings.seed = seed;
  return settings;
}

// Returns a rectangle of two triangles.
inline Mesh<3> wall(const std::string& name, const Vec3& corner, const Vec3& u, const Vec3& v,
                    const Rgb& albedo) {
  Mesh<3> mesh;
  mesh.name = name;
  for (const Vec3& p : {corner, corner + u, corner + u + v, corner + v}) {
    mesh.vertices.emplace_back(p);
  }
  mesh.facets = {{0, 1, 2}, {0, 2, 3}};
  mesh.albedo = albedo;
  return mesh;
}

// Returns a wall in the plane, whose left side is inside.
inline Mesh<2> wall(const Vec<2>& corner, const Vec<2>& edge, const Rgb& albedo) {
  Mesh<2> mesh;
  mesh.name = "wall";
  mesh.vertices = {Vec<2, float>(corner), Vec<2, float>(corner + edge)};
  mesh.facets = {{0, 1}};
  mesh.albedo = albedo;
  return mesh;
}

// A wall of the cube [low, high]^3, as a corner and edges; edge_u x edge_v points inwards.
struct Side {
  Vec3 corner, u, v;
};
inline std::vector<Side> cube_sides(double low, double high) {
  const double s = high - low;
  const Vec3 x(s, 0, 0), y(0, s, 0), z(0, 0, s), a(low), b(high);
  return {{a, y, z}, {a, z, x}, {a, x, y}, {b, -z, -y}, {b, -x, -z}, {b, -y, -x}};
}

// Returns a closed box around a field of the unit cube; its walls emit `emission` and reflect
// `albedo`. If the isosurfaces are white, the radiance is emission / (1 - albedo) everywhere.
inline Scene<3> furnace(Field<3> field, const IsovalueRange& isovalue_range, Real emission,
                        Real albedo) {
  Scene<3> scene = scene_of(std::move(field), Rgb(1), isovalue_range);
  for (const Side& side : cube_sides(-0.3, 1.3)) {
    scene.meshes.push_back(wall("wall", side.corner, side.u, side.v, Rgb(albedo)));
    scene.lights.push_back(AreaLight<3>{"glow", side.corner, {side.u, side.v}, Rgb(emission)});
  }
  return scene;
}

// Returns a box open towards -y, with colored walls left and right and a lamp below its ceiling.
inline Scene<3> cornell(Field<3> field, const IsovalueRange& isovalue_range) {
  Scene<3> scene = scene_of(std::move(field), Rgb(0.75f), isovalue_range);
  const std::vector<Side> sides = cube_sides(-0.3, 1.3);
  const std::vector<Rgb> albedos{Rgb(0.63f, 0.06f, 0.05f), Rgb(0),    Rgb(0.7f),
                                 Rgb(0.14f, 0.45f, 0.09f), Rgb(0.7f), Rgb(0.7f)};
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 1) continue;  // open
    scene.meshes.push_back(
        wall("wall " + std::to_string(i), sides[i].corner, sides[i].u, sides[i].v, albedos[i]));
  }
  scene.lights.push_back(
      AreaLight<3>{"lamp", {0.2, 0.2, 1.28}, {Vec3(0, 0.6, 0), Vec3(0.6, 0, 0)}, Rgb(3.0f)});
  return scene;
}

// Returns a box in the plane that is open at the bottom and has colored walls left and right. A
// lamp above shines down.
inline Scene<2> flat_cornell() {
  Scene<2> scene = scene_of(ball<2>(65), Rgb(0.75f), {0.55, 0.9});
  scene.meshes = {wall(Vec<2>(1.3, -0.3), {0, 1.6}, Rgb(0.1f, 0.5f, 0.1f)),
                  wall(Vec<2>(1.3, 1.3), {-1.6, 0}, Rgb(0.7f)),
                  wall(Vec<2>(-0.3, 1.3), {0, -1.6}, Rgb(0.6f, 0.1f, 0.1f))};
  scene.lights.push_back(AreaLight<2>{"lamp", {0.8, 1.25}, {Vec<2>(-0.6, 0)}, Rgb(3)});
  return scene;
}

}  // namespace leaflight::test
