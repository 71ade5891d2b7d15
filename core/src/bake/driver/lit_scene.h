// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/direct/direct_light.h"
#include "bake/plan/plan.h"
#include "bake/texels/line_volume.h"
#include "bake/walls/mesh_direct_light.h"
#include "transport/light_sampler.h"

namespace leaflight {

// How finely walls are lit. One way of every `share` to points of lights is traced
// (MeshDirectLight); `samples`: of each vertex at each node, where lines light the volume.
struct WallDetail {
  int samples = 8;
  std::size_t share = 1;
};
inline constexpr WallDetail least_wall_detail{2, light_point_sets};

// A scene made ready for light: what its integrators share. All that it is given must outlive it.
template <int D>
struct LitScene {
  const BakeSettings<D>& settings;
  const Plan& plan;
  Progress& progress;
  SceneTracer<D> tracer;
  LightSampler<D> lights;
  SplitLight<D> split;
  std::vector<LineVolume<D>> volumes;
  // Of each volume, once it is known; null where no texel stores light.
  std::vector<std::shared_ptr<const DirectLight<D>>> direct;
  WallDetail wall_detail;
  std::shared_ptr<const MeshDirectLight<D>> direct_of_walls;  // once it is known

  // Throws Error where lights are walled in.
  LitScene(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
           Progress& progress);
  LitScene(const LitScene&) = delete;

  int sides() const { return plan.back ? 2 : 1; }
  // What mirrors and glass show depends on the view, so that no texel can hold it.
  bool stores_light_of(std::size_t volume) const {
    return tracer.scene().volumes[volume].scattering == Scattering::diffuse;
  }
  // The walls' meshes, which are cut when they are first asked for.
  const std::vector<SubdividedMesh<D>>& subdivided();
  // Computes the maps of the points of `split`; `texels`: the resolution of each volume's;
  // `spacing`: as VisibilitySweep has it.
  void learn_direct(const std::vector<Index<D>>& texels, double spacing);
  // Once for each detail.
  void learn_direct_of_walls();
  // What they still are for the progress. Paths light walls in their blocks.
  double cost_of_walls();

 private:
  std::vector<EmptySpace<D>> empty_;  // of each volume, below the isovalue range
  std::vector<SubdividedMesh<D>> subdivided_;
  std::size_t learned_share_ = 0;  // of the walls' direct light; 0: none
};

}  // namespace leaflight
