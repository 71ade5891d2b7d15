// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/light_surroundings.h"

#include <algorithm>

#include "leaflight/bake/smooth_surroundings.h"
#include "leaflight/math/parallel.h"

namespace leaflight {
namespace {

constexpr std::size_t vertices_per_piece = 64;
// A side of the surroundings is tried at every so many vertices before it is lit.
constexpr std::size_t probe_stride = 16;
// Of smooth(): with few of them indirect light has streaks that the eye sees on walls, though they
// hardly count into the error.
constexpr int smoothing_passes = 9;

using Radiance = std::vector<Vec<3, float>>;

bool dark(const Halves& halves) {
  const auto all_dark = [](const Radiance& radiance) {
    return std::all_of(radiance.begin(), radiance.end(),
                       [](const auto& r) { return r == Vec<3, float>(0); });
  };
  return all_dark(halves[0]) && all_dark(halves[1]);
}

template <int D>
class SurroundingsLighter {
 public:
  SurroundingsLighter(const SceneTracer<D>& tracer, const PointSampler<D>& sampler,
                      const IndirectEstimator<D>* estimator, const SurroundingsWork<D>& work,
                      Progress& progress, std::atomic<std::uint64_t>& rays)
      : tracer_(tracer),
        sampler_(sampler),
        estimator_(estimator),
        work_(work),
        progress_(progress),
        rays_(rays),
        nodes_(tracer.scene()) {}

  // One side of a mesh, for all nodes of c.
  Radiance side(int mesh, bool back) const {
    // A side that is dark at some of its points for all c is taken to be dark.
    if (dark(vertices(mesh, back, probe_stride))) return {};
    return smooth(work_.meshes[mesh].coarse, vertices(mesh, back, 1), smoothing_passes, progress_);
  }

 private:
  Halves vertices(int mesh, bool back, std::size_t stride) const {
    const FineMesh<D>& lit = work_.meshes[mesh].coarse;
    const std::size_t n = (lit.places.size() + stride - 1) / stride, count = n * LeafNodes::count;
    Halves light{Radiance(count), Radiance(count)};
    parallel_range(count, vertices_per_piece, work_.samples * work_.rays_per_sample, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     std::uint64_t rays = 0;
                     for (std::size_t e = begin; e < end && !progress_.cancelled(); ++e) {
                       const std::size_t vertex = e % n * stride;
                       const SurfacePoint<D> point = vertex_point(
                           tracer_, lit, vertex, !back, nodes_.node(static_cast<int>(e / n)));
                       // All nodes of a vertex share their random numbers: what noise is left
                       // stands still while the isovalue moves.
                       const SampleKeys keys =
                           sample_keys(work_.seed, Purpose::surroundings, 2 * mesh + back,
                                       static_cast<std::uint32_t>(vertex));
                       for (const int half : {0, 1}) {
                         light[half][e] = mean(half, [&](int i) {
                           return sampler_.direct(point, keys, i, rays) +
                                  sampler_.indirect(point, estimator_, keys, i, rays);
                         });
                       }
                     }
                     rays_ += rays;
                   });
    return light;
  }

  // Of one half of the samples.
  template <class Sample>
  Vec<3, float> mean(int half, Sample sample) const {
    Imath::V3d sum(0);
    const int samples = std::max(1, work_.samples / 2);
    for (int i = half * samples; i < (half + 1) * samples; ++i) sum += Imath::V3d(sample(i));
    return Vec<3, float>(sum / samples);
  }

  const SceneTracer<D>& tracer_;
  const PointSampler<D>& sampler_;
  const IndirectEstimator<D>* estimator_;
  const SurroundingsWork<D>& work_;
  Progress& progress_;
  std::atomic<std::uint64_t>& rays_;
  LeafNodes nodes_;
};

}  // namespace

template <int D>
SurroundingsRadiance<D> light_surroundings(const SceneTracer<D>& tracer,
                                           const PointSampler<D>& sampler,
                                           const IndirectEstimator<D>* estimator,
                                           SurroundingsWork<D> work, Progress& progress,
                                           std::atomic<std::uint64_t>& rays) {
  const SplitLight<D> split = split_light(tracer);
  const LightSampler<D> wide(tracer, split);
  const PointSampler<D> but_points{wide, sampler.leaves, sampler.surroundings, sampler.caustics};
  const SurroundingsLighter<D> lighter(tracer, but_points, estimator, work, progress, rays);
  SurroundingsRadiance<D> result;
  result.direct = std::make_shared<const MeshDirectLight<D>>(tracer, work.meshes, progress);
  result.nodes = LeafNodes(tracer.scene());
  result.radiance.resize(work.meshes.size());
  for (std::size_t m = 0; m < result.radiance.size(); ++m) {
    if (tracer.scene().meshes[m].scattering != Scattering::diffuse) continue;
    for (const bool back : {false, true}) {
      result.radiance[m][back] = lighter.side(static_cast<int>(m), back);
    }
  }
  result.meshes = std::move(work.meshes);
  return result;
}

template SurroundingsRadiance<2> light_surroundings(const SceneTracer<2>&, const PointSampler<2>&,
                                                    const IndirectEstimator<2>*,
                                                    SurroundingsWork<2>, Progress&,
                                                    std::atomic<std::uint64_t>&);
template SurroundingsRadiance<3> light_surroundings(const SceneTracer<3>&, const PointSampler<3>&,
                                                    const IndirectEstimator<3>*,
                                                    SurroundingsWork<3>, Progress&,
                                                    std::atomic<std::uint64_t>&);

}  // namespace leaflight
