// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/plan.h"

#include <algorithm>

namespace leaflight {
namespace {

template <int D>
bool anything_reflects(const Scene<D>& scene) {
  return largest(scene.leaf_albedo) > 0 ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh<D>& mesh) { return largest(mesh.albedo) > 0; });
}

// Whether a leaf of the window meets the border of the domain or a masked cell, where light can
// reach its inside.
template <int D>
bool leaves_are_open(const Scene<D>& scene) {
  const Field<D>& field = scene.field;
  if (field.masked) return true;
  for (int axis = 0; axis < D; ++axis) {
    for (const int end : {0, field.dims[axis] - 1}) {
      Index<D> low{}, high = field.dims;
      low[axis] = end;
      high[axis] = end + 1;
      bool reaches = false;
      for_each_index<D>(low, high, [&](const Index<D>& voxel) {
        reaches |= field.values[field.offset(voxel)] >= scene.window.min;
      });
      if (reaches) return true;
    }
  }
  return false;
}

// A light in the domain may stand inside a leaf.
template <int D>
bool light_in_domain(const Scene<D>& scene) {
  Vec<D> low, high;
  for (const RectangleLight<D>& light : scene.lights) {
    for (int corner = 0; corner < 4; ++corner) {
      const Vec<D> p = scene.field.world_to_index.point(
          light.point({static_cast<double>(corner & 1), static_cast<double>(corner >> 1)}));
      for (int a = 0; a < D; ++a) {
        low[a] = corner == 0 ? p[a] : std::min(low[a], p[a]);
        high[a] = corner == 0 ? p[a] : std::max(high[a], p[a]);
      }
    }
    bool overlaps = true;
    for (int a = 0; a < D; ++a) {
      overlaps = overlaps && high[a] >= 0 && low[a] <= scene.field.dims[a] - 1;
    }
    if (overlaps) return true;
  }
  return false;
}

}  // namespace

template <int D>
Plan make_plan(const Scene<D>& scene, EstimatorName estimator) {
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

template Plan make_plan<2>(const Scene<2>&, EstimatorName);
template Plan make_plan<3>(const Scene<3>&, EstimatorName);

}  // namespace leaflight
