// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/settled_direct.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <numeric>

#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/parallel.h"

namespace leaflight {
namespace {

constexpr std::size_t vertices_per_piece = 256;
// Samples by which the light of a vertex is known as if nothing stood in its way.
constexpr int open_samples = 16;
// So many rays that agree are believed, whatever the neighbours see.
constexpr int agreeing_rays = 16;
// Of the light that a neighbour sees more or less.
constexpr float contrast = 0.25f;

int opened(int count) { return std::max(count, open_samples); }

// The share of the light that is seen; 0 where no ray was worth tracing.
template <class Samples>
float seen_share(const Samples& sum) {
  const auto traced = average(sum.traced);
  return traced > 0 ? static_cast<float>(average(sum.seen) / traced) : 0.0f;
}

template <class Samples>
float error_of(const Samples& sum) {
  if (sum.count == 0) return 0;
  const float share = std::min(1.0f, seen_share(sum));
  const auto open = static_cast<float>(average(sum.open)) / static_cast<float>(opened(sum.count));
  return open * std::sqrt(share * (1 - share) / static_cast<float>(sum.count));
}

}  // namespace

SettledDirect::SettledDirect(const SceneTracer<3>& tracer, const LightSampler<3>& lights,
                             const RestingLeaf& leaf, double tolerance, std::uint64_t seed)
    : tracer_(tracer),
      lights_(lights),
      leaf_(leaf),
      tolerance_(tolerance),
      seed_(seed),
      samples_(leaf.vertices.size()),
      chosen_(leaf.vertices.size()) {
  std::iota(chosen_.begin(), chosen_.end(), 0);
}

void SettledDirect::trace_vertex(std::size_t vertex, int count, std::uint64_t& rays) {
  const VertexSpots spots = spots_of(tracer_, leaf_, vertex);
  const std::uint64_t key = random_for(seed_, Purpose::settle, vertex).bits();
  const auto sample = [&](int i) -> DirectSample<3> {
    const SurfacePoint<3>& point = spots[i % spots.size()];
    if (point.kind() == HitKind::none) return {};
    const double choice = lights_.has_choice() ? sobol_point(i, ~key)[0] : 0;
    return lights_.direct_sample(point, choice, sobol_point(i, key));
  };
  Samples& sum = samples_[vertex];
  std::array<DirectSample<3>, open_samples> first;
  const bool starts = sum.count == 0;
  for (int i = 0; starts && i < open_samples; ++i) {
    first[i] = sample(i);
    sum.open += first[i].radiance;
  }
  // Where no light comes from above the surface no ray is needed, ever.
  for (int i = sum.count; i < count && largest(sum.open) > 0; ++i) {
    const DirectSample<3> found = starts && i < open_samples ? first[i] : sample(i);
    if (i >= open_samples) sum.open += found.radiance;
    if (!(largest(found.radiance) > 0)) continue;
    sum.traced += found.radiance;
    ++rays;
    if (!lights_.hidden(spots[i % spots.size()], found.light)) sum.seen += found.radiance;
  }
  sum.count = count;
}

bool SettledDirect::needs_more(std::size_t vertex) const {
  const Samples& sum = samples_[vertex];
  if (!(largest(sum.open) > 0)) return false;
  const float share = seen_share(sum);
  if (share > 0 && share < 1) return error_of(sum) > tolerance_;
  if (sum.count >= agreeing_rays) return false;
  for (std::size_t i = 0; i < leaf_.fans.size(vertex); ++i) {
    const Samples& other = samples_[leaf_.fans.others(vertex, i)[0]];
    if (std::abs(seen_share(other) - share) > contrast) return true;
  }
  return false;
}

void SettledDirect::trace(Progress& progress, std::uint64_t& rays) {
  const int count = rays_after[round_];
  std::atomic<std::uint64_t> all{0};
  const std::size_t n = chosen_.size();
  parallel_range(n, vertices_per_piece, 1.0 / static_cast<double>(n), progress,
                 [&](std::size_t begin, std::size_t end) {
                   std::uint64_t traced = 0;
                   for (std::size_t i = begin; i < end && !progress.cancelled(); ++i) {
                     trace_vertex(chosen_[i], count, traced);
                   }
                   all += traced;
                 });
  rays += all;
  ++round_;
  std::vector<char> more(samples_.size());
  tbb::parallel_for(std::size_t{0}, more.size(), [&](std::size_t v) { more[v] = needs_more(v); });
  chosen_.clear();
  for (std::size_t v = 0; v < more.size(); ++v) {
    if (more[v]) chosen_.push_back(static_cast<std::uint32_t>(v));
  }
}

std::vector<Vec<3, float>> SettledDirect::radiance() const {
  std::vector<Vec<3, float>> result;
  result.reserve(samples_.size());
  for (const Samples& sum : samples_) {
    Rgb direct = sum.open / static_cast<Real>(opened(sum.count));
    for (int k = 0; k < 3; ++k) {
      direct[k] *= sum.traced[k] > 0 ? sum.seen[k] / sum.traced[k] : 0;
    }
    result.emplace_back(direct);
  }
  return result;
}

std::vector<float> SettledDirect::error() const {
  std::vector<float> result;
  result.reserve(samples_.size());
  for (const Samples& sum : samples_) result.push_back(error_of(sum));
  return result;
}

}  // namespace leaflight
