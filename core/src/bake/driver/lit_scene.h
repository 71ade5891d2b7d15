// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "bake/direct/map_parts.h"
#include "bake/plan/plan.h"
#include "bake/texels/line_volume.h"
#include "bake/walls/shadow_ray_parts.h"
#include "transport/light_sampler.h"

namespace leaflight {

// Quality of the walls' light. `share`: one of this many shadow rays to light points is traced
// (MeshDirectLight). `samples`: paths per vertex and isovalue node, if lines light the volume.
struct WallDetail {
  int samples = 8;
  std::size_t share = 1;
};
inline constexpr WallDetail least_wall_detail{2, light_point_sets};

// A scene prepared for lighting, which its integrators share. The inputs must outlive it.
template <int D>
struct LitScene {
  const BakeSettings<D>& settings;
  const Plan& plan;
  Progress& progress;
  SceneTracer<D> tracer;
  LightSampler<D> lights;
  SplitLight<D> split;
  std::vector<LineVolume<D>> volumes;
  // Direct light of each volume, once it is computed; null if no texel of the volume stores light.
  std::vector<std::shared_ptr<const DirectLight<D>>> direct;
  WallDetail wall_detail;
  const Workers* workers = nullptr;  // processes that compute parts; may be null
  std::shared_ptr<const MeshDirectLight<D>> direct_of_walls;  // null before its computation

  // Throws Error if walls enclose all lights.
  LitScene(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
           Progress& progress);
  LitScene(const LitScene&) = delete;

  int sides() const { return plan.back ? 2 : 1; }
  // True if texels can store light. Reflections of mirrors and glass depend on the view.
  bool stores_light_of(std::size_t volume) const {
    return tracer.scene().volumes[volume].scattering == Scattering::diffuse;
  }
  // Returns the walls' meshes; subdivides them at the first call.
  const std::vector<SubdividedMesh<D>>& subdivided();
  // Computes the visibility maps of the points of `split`. `texels`: the resolution of each volume.
  // `spacing`: see VisibilitySweep.
  void compute_visibility_maps(const std::vector<Index<D>>& texels, double spacing);
  // Computes the direct light of the walls once for each detail.
  void compute_wall_direct_light();
  // Lets workers trace the shadow rays of fine walls.
  void share_shadow_rays();
  // Returns the remaining work for the walls in the unit of the progress. Paths light walls in
  // their blocks.
  double cost_of_walls();

 private:
  std::shared_ptr<const DirectLight<D>> shared_maps(const MapSettings<D>& settings) const;

  std::vector<EmptySpace<D>> empty_;  // below the isovalue range; one per volume
  std::vector<SubdividedMesh<D>> subdivided_;
  std::optional<ShadowRayParts<D>> shadow_rays_;  // those that workers trace
  SharedParts shared_;
  std::size_t computed_share_ = 0;  // share of the walls' direct light; 0: none yet
};

}  // namespace leaflight
