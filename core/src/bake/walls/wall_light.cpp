// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/wall_light.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/short_float.h"

namespace leaflight {
namespace {

constexpr std::size_t samples_per_piece = 64;
// Passes of smooth(). With few passes, indirect light has visible streaks on walls, although the
// error hardly changes.
constexpr int smoothing_passes = 9;

// Stride of the vertices that are tested before a side of the walls is lit.
constexpr std::size_t probe_stride = 16;
// Work of a sample, in the unit of the progress: points of lines.
constexpr double points_of_lines_per_sample = 7;
// Returns the work of `samples` samples per entry, which is a vertex at a node.
double work_of(int samples, double entries) {
  return points_of_lines_per_sample * samples * entries;
}

constexpr int node_bits = 6;
static_assert(IsovalueNodes::count <= 1 << node_bits);

bool is_dark(const std::vector<Vec<3, float>>& radiance) {
  return std::all_of(radiance.begin(), radiance.end(),
                     [](const auto& one) { return one == Vec<3, float>(0); });
}

// Returns the Morton code of a position in a box, which interleaves the bits of its coordinates.
template <int D>
std::uint64_t morton_code(const Vec<D>& place, const Box<D>& box) {
  constexpr int bits = 16;
  const double scale = ((1 << bits) - 1) / std::max(box.longest_side(), 1e-300);
  std::uint64_t code = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    for (int a = 0; a < D; ++a) {
      const auto along = static_cast<std::uint32_t>((place[a] - box.low[a]) * scale);
      code = code << 1 | (along >> bit & 1);
    }
  }
  return code;
}

// Returns the ranks of vertices along Morton's curve, on which consecutive vertices are neighbors.
template <int D>
std::vector<std::uint32_t> ranks_along_curve(const std::vector<Vec<D, float>>& vertices) {
  Box<D> box;
  for (const auto& vertex : vertices) box.extend(Vec<D>(vertex));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    sorted.emplace_back(morton_code<D>(Vec<D>(vertices[v]), box), v);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> ranks(vertices.size());
  for (std::uint32_t rank = 0; rank < ranks.size(); ++rank) ranks[sorted[rank].second] = rank;
  return ranks;
}

// Returns the rank of a vertex at a node. Neighboring vertices and nodes have close ranks.
template <int D>
std::uint32_t rank_at_node(std::uint32_t vertex, std::size_t node) {
  std::uint32_t rank = 0;
  int place = 0;
  for (int bit = 0; bit < node_bits; ++bit) {
    rank |= static_cast<std::uint32_t>(node >> bit & 1) << place++;
    for (int a = 0; a < D - 1; ++a, vertex >>= 1) rank |= (vertex & 1) << place++;
  }
  return rank | vertex << place;
}

}  // namespace

template <int D>
WallLight<D>::WallLight(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes)
    : tracer_(tracer), meshes_(meshes), nodes_(tracer.scene()), sums_(meshes.size()) {
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const std::size_t count =
        is_diffuse(m) ? meshes_[m].coarse.places.size() * IsovalueNodes::count : 0;
    for (Halves& side : sums_[m]) side.fill(std::vector<Vec<3, float>>(count, Vec<3, float>(0)));
    ranks_.push_back(ranks_along_curve<D>(meshes_[m].coarse.vertices));
  }
}

template <int D>
double WallLight<D>::work(int samples) const {
  double entries = 0;  // vertices at nodes
  for (const auto& sides : sums_) {
    for (const Halves& side : sides) entries += static_cast<double>(side[0].size());
  }
  return work_of(samples, entries);
}

// Returns mean radiances at every `stride`-th vertex of one side, for all nodes.
template <int D>
std::vector<Vec<3, float>> WallLight<D>::means(std::size_t mesh, bool back, std::size_t stride,
                                               const PointSampler<D>& from,
                                               const IndirectEstimator<D>* estimator,
                                               const WallSamples& samples,
                                               Progress& progress) const {
  // The ranks split one low-discrepancy sequence among all entries. So the samples of any
  // neighborhood, over which light is smoothed, are as even as those of one vertex (Ahmed and Wonka
  // 2020).
  const SampleKeys keys = sample_keys(samples.seed, Purpose::walls, 2 * mesh + back,
                                      static_cast<std::uint32_t>(added_));
  const FineMesh<D>& fine = meshes_[mesh].coarse;
  const std::size_t n = (fine.places.size() + stride - 1) / stride;
  std::vector<Vec<3, float>> means(n * IsovalueNodes::count);
  parallel_range(means.size(), samples_per_piece, points_of_lines_per_sample * samples.count,
                 progress, [&](std::size_t begin, std::size_t end) {
                   std::uint64_t traced = 0;
                   for (std::size_t e = begin; e < end && !progress.cancelled(); ++e) {
                     const std::size_t vertex = e % n * stride;
                     const double c = nodes_.node(static_cast<int>(e / n));
                     const SurfacePoint<D> point = vertex_point(tracer_, fine, vertex, !back, c);
                     const int first = samples.count * static_cast<int>(rank_at_node<D>(
                                                           ranks_[mesh][vertex], e / n));
                     Imath::V3d sum(0);
                     for (int i = first; i < first + samples.count; ++i) {
                       sum += Imath::V3d(from.direct(point, keys, i, traced) +
                                         from.indirect(point, estimator, keys, i, traced));
                     }
                     means[e] = Vec<3, float>(sum / samples.count);
                   }
                   progress.count_rays(traced);
                 });
  return means;
}

template <int D>
void WallLight<D>::add(const PointSampler<D>& from, const IndirectEstimator<D>* estimator,
                       const WallSamples& samples, Progress& progress) {
  progress.begin("Lighting walls");
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    for (const bool back : {false, true}) {
      Halves& sums = sums_[m][back];
      if (sums[0].empty()) continue;
      // A side that is dark at these vertices for all c is assumed to be dark.
      if (added_ == 0 &&
          is_dark(means(m, back, probe_stride, from, estimator, samples, progress))) {
        sums = {};
        continue;
      }
      const auto found = means(m, back, 1, from, estimator, samples, progress);
      std::vector<Vec<3, float>>& half = sums[added_ % 2];
      for (std::size_t e = 0; e < half.size(); ++e) half[e] += found[e];
    }
  }
  ++added_;
}

template <int D>
void WallLight<D>::serialize(Archive& archive) {
  archive(added_);
  for (auto& sides : sums_) {
    for (Halves& side : sides) {
      for (auto& half : side) archive(half, half.size());
    }
  }
}

// Returns smoothed means; empty if the side is dark for all c.
template <int D>
Halves WallLight<D>::smoothed(std::size_t mesh, bool back, Progress& progress) const {
  Halves halves = sums_[mesh][back];
  if (halves[0].empty() || (is_dark(halves[0]) && is_dark(halves[1]))) return {};
  for (int half = 0; half < 2; ++half) {
    const int count = (added_ + 1 - half) / 2;
    for (auto& radiance : halves[half]) radiance /= static_cast<float>(std::max(1, count));
  }
  return smooth(meshes_[mesh].coarse, std::move(halves), smoothing_passes, progress);
}

template <int D>
WallRadiance<D> WallLight<D>::radiance(std::shared_ptr<const MeshDirectLight<D>> direct,
                                       Progress& progress) {
  WallRadiance<D> result;
  result.direct = std::move(direct);
  result.nodes = nodes_;
  result.meshes = meshes_;
  result.radiance.resize(meshes_.size());
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    for (const bool back : {false, true}) {
      std::vector<Vec<3, float>>& radiance = result.radiance[m][back];
      radiance = mean(smoothed(m, back, progress));
      // Round to the precision of texels, because the zeros that follow take hardly any place in a
      // file.
      for (Vec<3, float>& light : radiance) light = ShortFloat().rounded(light);
    }
  }
  return result;
}

template <int D>
void WallLight<D>::add_noise(double exposure, IsovalueErrors& errors, Progress& progress) {
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    for (const bool back : {false, true}) {
      const Halves halves = smoothed(m, back, progress);
      const std::size_t vertices = meshes_[m].coarse.places.size();
      for (std::size_t e = 0; e < halves[0].size(); ++e) {
        // The error of the mean is half the difference of the halves.
        const Vec<3, float> off = (halves[0][e] - halves[1][e]) * static_cast<float>(exposure / 2);
        errors.add_noise(nodes_.node(static_cast<int>(e / vertices)), 1, off.length2() / 3);
      }
    }
  }
}

template <int D>
double work_of_samples(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                       int samples) {
  double vertices = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (tracer.meshes()[m].scattering != Scattering::diffuse) continue;
    vertices += static_cast<double>(meshes[m].coarse.vertices.size());
  }
  constexpr int sides = 2;
  return work_of(samples, sides * IsovalueNodes::count * vertices);
}

template class WallLight<2>;
template class WallLight<3>;
template double work_of_samples(const SceneTracer<2>&, const std::vector<SubdividedMesh<2>>&, int);
template double work_of_samples(const SceneTracer<3>&, const std::vector<SubdividedMesh<3>>&, int);

}  // namespace leaflight
