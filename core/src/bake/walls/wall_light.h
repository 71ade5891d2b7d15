// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/texels/checkpoint.h"
#include "bake/texels/isovalue_error.h"
#include "bake/texels/point_sampler.h"
#include "bake/walls/smooth_walls.h"
#include "bake/walls/wall_radiance.h"

namespace leaflight {

// Of each vertex at each node.
struct WallSamples {
  std::uint64_t seed;
  int count;
};

// The radiance of both sides of the diffuse walls from any number of samples: the direct
// light of points for all c, all else at every node of c. Samples come in two halves, by which
// noise is known and taken out.
template <int D>
class WallLight {
 public:
  // `meshes`: the scene's. Refers to both.
  WallLight(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes);

  // For one half, in turns. `from`: of all light but that of points. The estimator may be null
  // where there is no indirect light.
  void add(const PointSampler<D>& from, const IndirectEstimator<D>* estimator,
           const WallSamples& samples, Progress& progress);
  // What add() of so many samples is for the progress, in points of lines: less where a side is
  // known to be dark.
  double work(int samples) const;
  // How often samples were added.
  int blocks() const { return added_; }
  // Its state.
  void serialize(Archive& archive);

  // `direct`: of the same scene.
  WallRadiance<D> radiance(std::shared_ptr<const MeshDirectLight<D>> direct, Progress& progress);
  // The noise of that, each vertex alike.
  void add_noise(double exposure, IsovalueErrors& errors, Progress& progress);

 private:
  std::vector<Vec<3, float>> means(std::size_t mesh, bool back, std::size_t stride,
                                   const PointSampler<D>& from,
                                   const IndirectEstimator<D>* estimator,
                                   const WallSamples& samples, Progress& progress) const;
  Halves smoothed(std::size_t mesh, bool back, Progress& progress) const;
  bool is_diffuse(std::size_t mesh) const {
    return tracer_.scene().meshes[mesh].scattering == Scattering::diffuse;
  }

  const SceneTracer<D>& tracer_;
  const std::vector<SubdividedMesh<D>>& meshes_;
  IsovalueNodes nodes_;
  std::vector<std::vector<std::uint32_t>> ranks_;  // of coarse vertices; neighbours have near ones
  // Sums of means, by mesh and side; [node * vertices + vertex]. Empty where it is dark.
  std::vector<std::array<Halves, 2>> sums_;
  int added_ = 0;
};

// The same before any is known.
template <int D>
double work_of_samples(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                       int samples);

}  // namespace leaflight
