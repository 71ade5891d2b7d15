// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/plan.h"

#include <algorithm>

namespace leaflight {
namespace {

bool anything_reflects(const Scene& scene) {
  return largest(scene.leaf_albedo) > 0 ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return largest(mesh.albedo) > 0; });
}

// Whether a leaf of the window meets the border of the domain or a masked cell, where light can
// reach its inside.
bool leaves_are_open(const Scene& scene) {
  const Field<3>& field = scene.field;
  if (field.masked) return true;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int end : {0, field.dims[axis] - 1}) {
      Index<3> i;
      i[axis] = end;
      for (i[u] = 0; i[u] < field.dims[u]; ++i[u]) {
        for (i[v] = 0; i[v] < field.dims[v]; ++i[v]) {
          if (field.values[field.offset(i)] >= scene.window.min) return true;
        }
      }
    }
  }
  return false;
}

// A light in the domain may stand inside a leaf.
bool light_in_domain(const Scene& scene) {
  Vec3 low, high;
  for (const RectangleLight& light : scene.lights) {
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 p = scene.field.world_to_index.point(light.point(corner & 1, corner >> 1));
      for (int a = 0; a < 3; ++a) {
        low[a] = corner == 0 ? p[a] : std::min(low[a], p[a]);
        high[a] = corner == 0 ? p[a] : std::max(high[a], p[a]);
      }
    }
    bool overlaps = true;
    for (int a = 0; a < 3; ++a) {
      overlaps = overlaps && high[a] >= 0 && low[a] <= scene.field.dims[a] - 1;
    }
    if (overlaps) return true;
  }
  return false;
}

}  // namespace

Plan make_plan(const Scene& scene, EstimatorName estimator) {
  Plan plan;
  const auto skip = [&](bool Plan::*pass, const std::string& name, const std::string& reason) {
    plan.*pass = false;
    plan.skipped.push_back({name, reason});
  };
  if (!anything_reflects(scene)) {
    skip(&Plan::indirect, "indirect light", "nothing in the scene reflects light");
  }
  if (!plan.indirect) {
    skip(&Plan::photons, "photons", "there is no indirect light");
  } else if (estimator == EstimatorName::path) {
    skip(&Plan::photons, "photons", "the path estimator needs none");
  }
  if (!plan.photons) {
    skip(&Plan::surroundings_cache, "surroundings cache", "no photons are traced");
  } else if (estimator == EstimatorName::volumetric) {
    skip(&Plan::surroundings_cache, "surroundings cache", "the volumetric estimator needs none");
  } else if (scene.meshes.empty()) {
    skip(&Plan::surroundings_cache, "surroundings cache", "nothing surrounds the volume");
  }
  if (!plan.photons) {
    skip(&Plan::inner_side, "inner side", "no photons are traced");
  } else if (!leaves_are_open(scene) && !light_in_domain(scene)) {
    skip(&Plan::inner_side, "inner side",
         "every isosurface of the window is closed and no light stands within the volume");
  }
  return plan;
}

}  // namespace leaflight
