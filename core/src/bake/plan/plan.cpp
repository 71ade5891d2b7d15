// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/plan/plan.h"

#include <algorithm>

#include "scene/open_isosurfaces.h"

namespace leaflight {
namespace {

template <int D>
bool anything_reflects(const Scene<D>& scene) {
  return std::any_of(scene.volumes.begin(), scene.volumes.end(),
                     [](const Volume<D>& volume) { return volume.albedo.largest() > 0; }) ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh<D>& mesh) { return largest(mesh.albedo) > 0; });
}

// True if the box around some points, in index coordinates, overlaps the field's domain.
template <int D>
bool overlaps_domain(const Field<D>& field, const std::vector<Vec<D>>& points) {
  Box<D> box, domain{Vec<D>(0.0), Vec<D>(0.0)};
  for (const Vec<D>& point : points) box.extend(field.world_to_index.point(point));
  for (int a = 0; a < D; ++a) domain.high[a] = field.dims[a] - 1;
  return box.overlaps(domain);
}

// True if light may come from inside an isosurface. A light or an emissive mesh may be inside one.
// Emissive isosurfaces light each other from inside, even those of other volumes.
template <int D>
bool light_in_domain(const Scene<D>& scene, const Volume<D>& volume) {
  if (volume.emission.largest() > 0) return true;
  for (const Light<D>& light : scene.lights) {
    const auto points = std::visit([](const auto& l) { return l.corners(); }, light);
    if (overlaps_domain<D>(volume.field, points)) return true;
  }
  for (const Mesh<D>& mesh : scene.meshes) {
    if (!(largest(mesh.emission) > 0)) continue;
    const std::vector<Vec<D>> points(mesh.vertices.begin(), mesh.vertices.end());
    if (overlaps_domain<D>(volume.field, points)) return true;
  }
  return volume.scattering == Scattering::glass;
}

}  // namespace

template <int D>
Plan make_plan(const Scene<D>& scene, const BakeSettings<D>& settings) {
  static const IndirectMethod lines{"line", true, true, false}, paths{"path", false, true, false};
  const bool takes_lines = scene.volumes.size() == 1 && !has_specular(scene);
  Plan plan = make_plan(scene, takes_lines ? lines : paths, settings.both_sides, settings.walls);
  plan.lines = takes_lines;
  return plan;
}

template <int D>
Plan make_plan(const Scene<D>& scene, const IndirectMethod& method, bool both_sides, bool walls) {
  Plan plan;
  const auto skip = [&](bool Plan::*pass, const std::string& name, const std::string& reason) {
    plan.*pass = false;
    plan.skipped.push_back({name, reason});
  };
  // Skip passes for light that the scene does not have.
  if (!anything_reflects(scene)) {
    skip(&Plan::indirect, "indirect light", "nothing in the scene reflects light");
  }
  if (!has_specular(scene)) {
    const std::string reason = "there is no mirror and no glass in the scene";
    skip(&Plan::specular, "specular light", reason);
    skip(&Plan::caustics, "caustics", reason);
  } else if (method.caustics) {
    skip(&Plan::caustics, "caustic photons",
         "caustics are part of the " + method.name + " estimator's light");
  }
  if (!plan.indirect) {
    skip(&Plan::photons, "photons", "there is no indirect light");
  } else if (!method.photons) {
    skip(&Plan::photons, "photons", "the " + method.name + " estimator needs none");
  }
  // Skip the walls and their cache.
  if (!walls) {
    skip(&Plan::walls, "radiance of the walls", "it was not asked for");
  } else if (scene.meshes.empty()) {
    skip(&Plan::walls, "radiance of the walls", "nothing surrounds the volume");
  }
  // True if photons carry light that a surface reflects.
  const bool is_carried = plan.photons || (plan.indirect && plan.caustics);
  if (!is_carried && !(plan.caustics && plan.walls)) {
    skip(&Plan::wall_cache, "cache of the walls", "no photons are traced");
  } else if (scene.meshes.empty()) {
    skip(&Plan::wall_cache, "cache of the walls", "nothing surrounds the volume");
  } else if (!method.walls && !plan.walls) {
    skip(&Plan::wall_cache, "cache of the walls", "the " + method.name + " estimator needs none");
  }
  // Skip backs that no light can reach.
  bool inside = false, open = false;
  for (const Volume<D>& volume : scene.volumes) {
    open = open || isosurfaces_are_open(volume, scene.isovalue_range);
    inside = inside || light_in_domain(scene, volume);
  }
  const std::string dark =
      "every isosurface of the isovalue range is closed and no light stands within the volume";
  if (!is_carried) {
    skip(&Plan::back_side, "back", "no photons are traced");
  } else if (!open && !inside) {
    skip(&Plan::back_side, "back", dark);
  }
  if (!open && !inside) {
    skip(&Plan::back, "radiance of the back", dark);
  } else if (!both_sides) {
    skip(&Plan::back, "radiance of the back", "it was not asked for");
  }
  return plan;
}

template <int D>
Error nothing_to_bake(const Scene<D>& scene) {
  for (const Volume<D>& volume : scene.volumes) {
    if (volume.scattering == Scattering::diffuse) continue;
    return Error("The isosurfaces of the volume '" + volume.name + "' are " +
                 (volume.scattering == Scattering::mirror ? "mirrors" : "glass") +
                 ", which store no light, and nothing else is baked; bake the walls too.");
  }
  return Error("No isosurface of the isovalue range passes through the volume; widen it.");
}

template Error nothing_to_bake(const Scene<2>&);
template Error nothing_to_bake(const Scene<3>&);
template Plan make_plan<2>(const Scene<2>&, const BakeSettings<2>&);
template Plan make_plan<3>(const Scene<3>&, const BakeSettings<3>&);
template Plan make_plan<2>(const Scene<2>&, const IndirectMethod&, bool, bool);
template Plan make_plan<3>(const Scene<3>&, const IndirectMethod&, bool, bool);

}  // namespace leaflight
