// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/resting_leaf.h"
#include "leaflight/math/progress.h"
#include "leaflight/transport/light_sampler.h"

namespace leaflight {

// Direct light at the vertices of a leaf's mesh: what would arrive if nothing stood in its way, by
// samples that cost no ray, times the share of it that shadow rays see. They are few at first, and
// more where those of a vertex disagree, or its neighbours see more or less.
class SettledDirect {
 public:
  // Rounds after which no vertex gets any more rays.
  static constexpr std::array<int, 5> rays_after{4, 8, 16, 32, 64};

  // All must outlive this. tolerance: the standard error of radiance at which a vertex is left
  // alone.
  SettledDirect(const SceneTracer<3>& tracer, const LightSampler<3>& lights,
                const RestingLeaf& leaf, double tolerance, std::uint64_t seed);

  // The next round; one that was cancelled may be traced again. Adds the rays traced to `rays`.
  void trace(Progress& progress, std::uint64_t& rays);

  std::vector<Vec<3, float>> radiance() const;
  // The standard error of its mean over the channels, as if samples were independent; they are
  // spread evenly and err less.
  std::vector<float> error() const;

 private:
  // Radiance of a vertex's samples, summed: as if nothing stood in their way; of those for which a
  // ray was traced; of those whose light it saw.
  struct Samples {
    Rgb open{0}, traced{0}, seen{0};
    int count = 0;
  };

  void trace_vertex(std::size_t vertex, int count, std::uint64_t& rays);
  bool needs_more(std::size_t vertex) const;

  const SceneTracer<3>& tracer_;
  const LightSampler<3>& lights_;
  const RestingLeaf& leaf_;
  double tolerance_;
  std::uint64_t seed_;
  std::size_t round_ = 0;
  std::vector<Samples> samples_;
  std::vector<std::uint32_t> chosen_;  // vertices of the next round, ascending
};

}  // namespace leaflight
