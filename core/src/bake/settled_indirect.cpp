// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/settled_indirect.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/parallel.h"

namespace leaflight {
namespace {

constexpr std::size_t vertices_per_piece = 128;
// Vertices have more than one path each where they are fewer than this.
constexpr std::size_t all_paths = 1'000'000, most_paths = 64;
// Some six hundred paths are averaged, if no more than two hundred vertices share theirs.
constexpr int most_smoothing_steps = 32, least_smoothing_steps = 2;

float square(float x) { return x * x; }
float channel_mean(const Vec<3, float>& v) { return (v.x + v.y + v.z) / 3; }

struct Half {
  Vec<3, float> sum;
  float count;

  explicit Half(const float* row) : sum(row[0], row[1], row[2]), count(row[3]) {}
  Vec<3, float> mean() const { return count > 0 ? sum / count : Vec<3, float>(0); }
};

std::vector<Vec<3, float>> smoothed(const MeshSmoother& smoother,
                                    const std::vector<Vec<3, float>>& values, int steps) {
  std::vector<std::array<float, 3>> rows;
  rows.reserve(values.size());
  for (const Vec<3, float>& value : values) rows.push_back({value.x, value.y, value.z});
  smoother.smooth(rows, steps);
  std::vector<Vec<3, float>> result;
  result.reserve(values.size());
  for (const auto& row : rows) result.emplace_back(row[0], row[1], row[2]);
  return result;
}

// The vertices by the Morton code of the voxel next to them, along a curve that stays near.
std::vector<std::uint32_t> morton_order(const Field<3>& field,
                                        const std::vector<Vec<3, float>>& vertices) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes(vertices.size());
  tbb::parallel_for(std::size_t{0}, codes.size(), [&](std::size_t v) {
    // Not that of their cell: they lie on its border.
    const Vec3 middle = field.world_to_index.point(Vec3(vertices[v])) + Vec3(0.5);
    const Index<3> cell = locate(field, middle).cell;
    std::uint64_t code = 0;
    for (int bit = 0; bit < 16; ++bit) {
      for (int a = 0; a < 3; ++a) {
        code |= static_cast<std::uint64_t>(cell[a] >> bit & 1) << (3 * bit + a);
      }
    }
    codes[v] = {code, static_cast<std::uint32_t>(v)};
  });
  tbb::parallel_sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> order;
  order.reserve(codes.size());
  for (const auto& [code, v] : codes) order.push_back(v);
  return order;
}

}  // namespace

SettledIndirect::SettledIndirect(const SceneTracer<3>& tracer, const LightSampler<3>& lights,
                                 const RestingLeaf& leaf, const std::vector<Vec<3, float>>& normals,
                                 std::vector<Vec<3, float>> baked, std::uint64_t seed)
    : tracer_(tracer),
      leaf_(leaf),
      smoother_(leaf.fans, normals),
      paths_(make_path_estimator(tracer, lights)),
      seed_(seed),
      paths_per_vertex_(static_cast<int>(std::clamp<std::size_t>(
          all_paths / std::max<std::size_t>(1, leaf.vertices.size()), 1, most_paths))),
      smoothing_steps_(std::clamp(3 * most_smoothing_steps / paths_per_vertex_,
                                  least_smoothing_steps, most_smoothing_steps)),
      order_(morton_order(tracer.scene().volumes[leaf.volume].field, leaf.vertices)),
      baked_(std::move(baked)),
      detail_(baked_),
      halves_(baked_.size(), std::array<float, 8>{}) {
  const std::vector<Vec<3, float>> mean = smoothed(smoother_, baked_, smoothing_steps_);
  for (std::size_t v = 0; v < detail_.size(); ++v) detail_[v] -= mean[v];
  mean_detail_ = smoothed(smoother_, detail_, smoothing_steps_);
}

float SettledIndirect::share_of_detail(const std::vector<Vec<3, float>>& more) const {
  // The slope of a regression, which one number for all the surface makes sure of.
  double together = 0, alone = 0;
  for (std::size_t v = 0; v < detail_.size(); ++v) {
    const Half a(halves_[v].data()), b(halves_[v].data() + 4);
    const float count = a.count + b.count;
    together += (a.sum + b.sum - more[v] * count).dot(detail_[v]);
    alone += count * detail_[v].length2();
  }
  return alone > 0 ? static_cast<float>(std::clamp(1 + together / alone, 0.0, 1.0)) : 1.0f;
}

void SettledIndirect::trace(Progress& progress, std::uint64_t& rays) {
  // The points of one sequence, along a curve that stays near, stratify neighbours against each
  // other.
  const std::size_t first = pass_ % passes_per_path;
  const auto after = static_cast<float>((pass_ / passes_per_path + 1) * paths_per_vertex_);
  Random keys = random_for(seed_, Purpose::settle, baked_.size() + pass_);
  const std::uint64_t direction_key = keys.bits(), path_key = keys.bits();
  const std::size_t n =
      baked_.size() > first ? (baked_.size() - first - 1) / passes_per_path + 1 : 0;
  std::atomic<std::uint64_t> all{0};
  parallel_range(n, vertices_per_piece, 1.0 / static_cast<double>(n), progress,
                 [&](std::size_t begin, std::size_t end) {
                   std::uint64_t traced = 0;
                   for (std::size_t i = begin; i < end && !progress.cancelled(); ++i) {
                     const std::uint32_t v = order_[first + i * passes_per_path];
                     auto& halves = halves_[v];
                     if (halves[3] + halves[7] >= after) continue;  // before it was cancelled
                     const VertexSpots spots = spots_of(tracer_, leaf_, v);
                     for (int k = 0; k < paths_per_vertex_; ++k) {
                       const std::size_t path = i * paths_per_vertex_ + k;
                       const SurfacePoint<3>& point = spots[path % spots.size()];
                       if (point.kind() == HitKind::none) continue;
                       Random random(path_key, 0, path);
                       const auto u = sobol_point(static_cast<std::uint32_t>(path), direction_key);
                       const Rgb found =
                           point.emission + paths_->indirect_radiance(point, u, random, traced);
                       float* half = halves.data() + ((i + k) % 2 == 0 ? 0 : 4);
                       for (int c = 0; c < 3; ++c) half[c] += found[c] - baked_[v][c];
                       ++half[3];
                     }
                   }
                   all += traced;
                 });
  rays += all;
  ++pass_;
}

SettledIndirect::Found SettledIndirect::found() const {
  Found found{baked_, std::vector<float>(baked_.size(), 0.0f)};
  if (pass_ == 0) return found;
  std::vector<std::array<float, 8>> halves = halves_;
  smoother_.smooth(halves, smoothing_steps_);
  std::vector<Vec<3, float>> more;
  more.reserve(halves.size());
  for (const auto& sums : halves) {
    const Half a(sums.data()), b(sums.data() + 4);
    const float count = a.count + b.count;
    more.push_back(count > 0 ? (a.sum + b.sum) / count : Vec<3, float>(0));
  }
  const float noise = 1 - share_of_detail(more);
  // Half the difference of the halves' means errs as the mean of all does.
  std::vector<std::array<float, 2>> squares(baked_.size());  // of the error, of the mean
  for (std::size_t v = 0; v < more.size(); ++v) {
    more[v] += mean_detail_[v] * noise;  // without its noise the bake lacks this, too
    const Half a(halves[v].data()), b(halves[v].data() + 4);
    squares[v] = {square(0.5f * (channel_mean(a.mean()) - channel_mean(b.mean()))),
                  square(channel_mean(more[v]))};
  }
  smoother_.smooth(squares, most_smoothing_steps);
  for (std::size_t v = 0; v < more.size(); ++v) {
    const auto [error, mean] = squares[v];
    const float share = mean > error ? 1 - error / mean : 0;
    for (int k = 0; k < 3; ++k) {
      found.radiance[v][k] =
          std::max(0.0f, baked_[v][k] - noise * detail_[v][k] + share * more[v][k]);
    }
    found.error[v] = std::sqrt(error);
  }
  return found;
}

}  // namespace leaflight
