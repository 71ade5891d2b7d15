// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/resting_leaf.h"
#include "leaflight/math/progress.h"
#include "leaflight/surface/mesh_smoother.h"
#include "leaflight/transport/indirect_estimator.h"

namespace leaflight {

// Indirect light at the vertices of a leaf's mesh: that of the bake, corrected by the mean over the
// neighbours on the mesh of what a few paths find differently; where vertices are few, each has
// many. The bake keeps the detail, the paths see which sheet they start on, and their mean may
// reach far since it varies little. What it differs by no more than noise does is left out
// (Wiener's filter): a bake that is right stays so. Of a bake's own noise as much is taken away as
// the paths do not find again.
class SettledIndirect {
 public:
  // A pass traces the paths of every so many vertices.
  static constexpr int passes_per_path = 4;

  // normals: unit; baked: radiance, both of the vertices. All but `baked` must outlive this.
  SettledIndirect(const SceneTracer<3>& tracer, const LightSampler<3>& lights,
                  const RestingLeaf& leaf, const std::vector<Vec<3, float>>& normals,
                  std::vector<Vec<3, float>> baked, std::uint64_t seed);

  // The next pass; one that was cancelled may be traced again. Adds the rays traced to `rays`.
  void trace(Progress& progress, std::uint64_t& rays);

  // Per vertex, radiance [W/(m^2 sr)] and the standard error of its correction, of the mean over
  // the channels, from how two halves of the paths differ; zero before the first pass.
  struct Found {
    std::vector<Vec<3, float>> radiance;
    std::vector<float> error;
  };
  Found found() const;

 private:
  // The share of the bake's detail that the paths find, too; the rest is noise. more: the mean of
  // what they find more.
  float share_of_detail(const std::vector<Vec<3, float>>& more) const;

  const SceneTracer<3>& tracer_;
  const RestingLeaf& leaf_;
  MeshSmoother smoother_;
  std::unique_ptr<IndirectEstimator<3>> paths_;
  std::uint64_t seed_;
  int paths_per_vertex_, smoothing_steps_;
  int pass_ = 0;
  std::vector<std::uint32_t> order_;           // the vertices, neighbours next to each other
  std::vector<Vec<3, float>> baked_, detail_;  // of it: what its neighbours' mean lacks
  std::vector<Vec<3, float>> mean_detail_;
  // Of two halves of a vertex's paths: what they found beyond the bake, summed, and their number.
  std::vector<std::array<float, 8>> halves_;
};

}  // namespace leaflight
