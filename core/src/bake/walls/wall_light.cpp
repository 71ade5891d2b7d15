// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/wall_light.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/short_float.h"

namespace leaflight {
namespace {

constexpr std::size_t samples_per_piece = 64, entries_a_part = 1 << 13;
// Passes of smooth(). With few passes, indirect light has visible streaks on walls, although the
// error hardly changes.
constexpr int smoothing_passes = 9;

// Stride of the vertices that are tested before a side of the walls is lit.
constexpr int probe_stride = 16;
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

template <int D>
double WallLight<D>::work_of_entry(int samples) {
  return work_of(samples, 1);
}

template <int D>
std::vector<Vec<3, float>> WallLight<D>::means(const BakePart& part, const PointSampler<D>& from,
                                               const IndirectEstimator<D>* estimator,
                                               const WallSamples& samples,
                                               Progress& progress) const {
  // The ranks split one low-discrepancy sequence among all entries. So the samples of any
  // neighborhood, over which light is smoothed, are as even as those of one vertex (Ahmed and Wonka
  // 2020).
  const SampleKeys keys = sample_keys(samples.seed, Purpose::walls,
                                      2 * static_cast<std::uint64_t>(part.mesh) + part.back,
                                      static_cast<std::uint32_t>(part.number));
  const FineMesh<D>& fine = meshes_[part.mesh].coarse;
  const std::size_t n = vertices(part);
  std::vector<Vec<3, float>> means(part.end - part.begin);
  parallel_range(
      means.size(), samples_per_piece, points_of_lines_per_sample * samples.count, progress,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t traced = 0;
        for (std::size_t i = begin; i < end && !progress.cancelled(); ++i) {
          const std::size_t entry = part.begin + i, vertex = entry % n * part.stride;
          const double c = nodes_.node(static_cast<int>(entry / n));
          const SurfacePoint<D> point = vertex_point(tracer_, fine, vertex, !part.back, c);
          const auto rank = static_cast<int>(rank_at_node<D>(ranks_[part.mesh][vertex], entry / n));
          Imath::V3d sum(0);
          for (int k = samples.count * rank; k < samples.count * (rank + 1); ++k) {
            sum += Imath::V3d(from.direct(point, keys, k, traced) +
                              from.indirect(point, estimator, keys, k, traced));
          }
          means[i] = Vec<3, float>(sum / samples.count);
        }
        progress.count_rays(traced);
      });
  return means;
}

template <int D>
std::size_t WallLight<D>::vertices(const BakePart& part) const {
  const auto stride = static_cast<std::size_t>(part.stride);
  return (meshes_[part.mesh].coarse.places.size() + stride - 1) / stride;
}

template <int D>
std::vector<BakePart> WallLight<D>::parts(int call, int stride) const {
  std::vector<BakePart> parts;
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    for (const int back : {0, 1}) {
      if (sums_[m][back][0].empty()) continue;
      BakePart of_side{PartKind::walls, back, call, static_cast<int>(m), stride};
      add_parts(parts, of_side, vertices(of_side) * IsovalueNodes::count, entries_a_part);
    }
  }
  return parts;
}

template <int D>
std::vector<BakePart> WallLight<D>::probes() const {
  return parts(0, probe_stride);
}

// A side that is dark at all of its probes for all c is assumed to be dark.
template <int D>
void WallLight<D>::drop_dark(const std::vector<BakePart>& probes,
                             const std::vector<std::vector<Vec<3, float>>>& means) {
  std::vector<std::array<char, 2>> is_lit(meshes_.size(), {0, 0});
  for (std::size_t i = 0; i < probes.size(); ++i) {
    if (!is_dark(means[i])) is_lit[probes[i].mesh][probes[i].back] = 1;
  }
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    for (const int back : {0, 1}) {
      if (!is_lit[m][back]) sums_[m][back] = {};
    }
  }
}

template <int D>
void WallLight<D>::add(const BakePart& part, const std::vector<Vec<3, float>>& means) {
  Vec<3, float>* half = sums_[part.mesh][part.back][part.number % 2].data() + part.begin;
  for (std::size_t e = 0; e < means.size(); ++e) half[e] += means[e];
}

template <int D>
void WallLight<D>::add(const PointSampler<D>& from, const IndirectEstimator<D>* estimator,
                       const WallSamples& samples, Progress& progress) {
  progress.begin("Lighting walls");
  const auto means_of = [&](const BakePart& part) {
    return means(part, from, estimator, samples, progress);
  };
  if (added_ == 0) {
    const std::vector<BakePart> first = probes();
    std::vector<std::vector<Vec<3, float>>> probed(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) probed[i] = means_of(first[i]);
    drop_dark(first, probed);
  }
  for (const BakePart& part : parts(added_)) add(part, means_of(part));
  end_call();
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
