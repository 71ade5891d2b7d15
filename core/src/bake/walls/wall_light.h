// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/plan/workers.h"
#include "bake/texels/checkpoint.h"
#include "bake/texels/isovalue_error.h"
#include "bake/texels/point_sampler.h"
#include "bake/walls/smooth_walls.h"
#include "bake/walls/wall_radiance.h"

namespace leaflight {

// Samples of each vertex at each node.
struct WallSamples {
  std::uint64_t seed;
  int count;
};

// The radiance of both sides of the diffuse walls from any number of samples. Direct light of
// points holds for all c, other light at every node of c. Samples form two halves, to estimate and
// remove noise.
template <int D>
class WallLight {
 public:
  // `meshes`: the scene's. Keeps references to both.
  WallLight(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes);

  // Adds samples to the halves alternately. `from`: samples all light except that of points. The
  // estimator is null if there is no indirect light.
  void add(const PointSampler<D>& from, const IndirectEstimator<D>* estimator,
           const WallSamples& samples, Progress& progress);
  // The same in parts: first all probes(), which find dark sides, then all parts() of each call.
  std::vector<BakePart> probes() const;
  void drop_dark(const std::vector<BakePart>& probes,
                 const std::vector<std::vector<Vec<3, float>>>& means);
  // Returns the parts of a call, from 0; their items are entries, node * vertices + vertex.
  std::vector<BakePart> parts(int call) const { return parts(call, 1); }
  // Returns the mean radiance of the items of a part.
  std::vector<Vec<3, float>> means(const BakePart& part, const PointSampler<D>& from,
                                   const IndirectEstimator<D>* estimator,
                                   const WallSamples& samples, Progress& progress) const;
  void add(const BakePart& part, const std::vector<Vec<3, float>>& means);
  void end_call() { ++added_; }

  // Returns the work of add() in points of lines; sides that are known to be dark take none.
  double work(int samples) const;
  static double work_of_entry(int samples);
  // Returns the number of calls of add().
  int blocks() const { return added_; }
  // Serializes the state.
  void serialize(Archive& archive);

  // Returns the radiance from the samples so far. `direct`: of the same scene.
  WallRadiance<D> radiance(std::shared_ptr<const MeshDirectLight<D>> direct, Progress& progress);
  // Adds the noise of radiance(), equally for each vertex.
  void add_noise(double exposure, IsovalueErrors& errors, Progress& progress);

 private:
  std::vector<BakePart> parts(int call, int stride) const;
  // Returns the number of vertices of a part's mesh, with its stride.
  std::size_t vertices(const BakePart& part) const;
  Halves smoothed(std::size_t mesh, bool back, Progress& progress) const;
  bool is_diffuse(std::size_t mesh) const {
    return tracer_.scene().meshes[mesh].scattering == Scattering::diffuse;
  }

  const SceneTracer<D>& tracer_;
  const std::vector<SubdividedMesh<D>>& meshes_;
  IsovalueNodes nodes_;
  std::vector<std::vector<std::uint32_t>> ranks_;  // of coarse vertices; neighbors have close ranks
  // Sums of means, by mesh and side; the index is node * vertices + vertex. Empty for dark sides.
  std::vector<std::array<Halves, 2>> sums_;
  int added_ = 0;
};

// Estimates the work before any side is known to be dark.
template <int D>
double work_of_samples(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                       int samples);

}  // namespace leaflight
