// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/plan/shared_parts.h"
#include "bake/texels/point_sampler.h"
#include "bake/walls/wall_light.h"
#include "base/progress.h"

namespace leaflight {

// The sources of the walls' light (wall_light.h). `sampler`: samples all light. `samples`: per
// vertex and node.
template <int D>
struct WallSources {
  const SceneTracer<D>& tracer;
  const std::vector<SubdividedMesh<D>>& meshes;
  const PointSampler<D>& sampler;
  const IndirectEstimator<D>* estimator;  // null: no indirect light
  int samples;
  std::uint64_t seed;
};

// Returns the bytes of parts of the walls' light, which others have computed.
using WallsOfOthers = std::function<std::vector<std::string>(const std::vector<BakePart>&)>;

// Computes the radiance of both sides of the diffuse walls.
template <int D>
class WallParts {
 public:
  explicit WallParts(const WallSources<D>& sources);
  WallParts(const WallParts&) = delete;

  // `direct`: of the same scene. `others` is null without workers.
  WallRadiance<D> radiance(std::shared_ptr<const MeshDirectLight<D>> direct, Progress& progress,
                           const WallsOfOthers& others = {});
  // Computes a part for another process, as bytes.
  std::string traced(const BakePart& part, Progress& progress) const {
    return bytes_of(means(part, progress));
  }
  // Returns the work of a part in points of lines.
  double work(const BakePart& part) const {
    return walls_.work_of_entry(samples_.count) * static_cast<double>(part.end - part.begin);
  }

 private:
  std::vector<Vec<3, float>> means(const BakePart& part, Progress& progress) const {
    return walls_.means(part, rest_, estimator_, samples_, progress);
  }
  template <class Take>
  void light(const std::vector<BakePart>& parts, Progress& progress, const WallsOfOthers& others,
             Take take) const;

  SplitLight<D> split_;
  LightSampler<D> wide_;  // without light points
  PointSampler<D> rest_;
  const IndirectEstimator<D>* estimator_;
  WallSamples samples_;
  WallLight<D> walls_;
};

}  // namespace leaflight
