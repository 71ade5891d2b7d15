// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/smooth_surroundings.h"

#include <algorithm>
#include <cmath>

#include "leaflight/math/parallel.h"

namespace leaflight {
namespace {

// In standard deviations of a difference: of vertices so far apart the one counts 1/e for the
// other.
constexpr float tolerance = 2;

// The vertices that share a facet with each, itself the first of them.
class Neighbours {
 public:
  template <int D>
  explicit Neighbours(const FineMesh<D>& mesh) : begins_(mesh.vertices.size() + 1, 0) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const auto& facet : mesh.facets) {
      for (const std::uint32_t a : facet) {
        for (const std::uint32_t b : facet) {
          if (a != b) pairs.emplace_back(a, b);
        }
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::size_t pair = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      vertices_.push_back(v);
      for (; pair < pairs.size() && pairs[pair].first == v; ++pair) {
        vertices_.push_back(pairs[pair].second);
      }
      begins_[v + 1] = vertices_.size();
    }
  }

  const std::uint32_t* begin(std::size_t v) const { return vertices_.data() + begins_[v]; }
  const std::uint32_t* end(std::size_t v) const { return vertices_.data() + begins_[v + 1]; }

 private:
  std::vector<std::size_t> begins_;
  std::vector<std::uint32_t> vertices_;
};

float distance2(const Vec<3, float>& a, const Vec<3, float>& b) { return (a - b).length2() / 3; }

// One node's vertices, of both halves.
struct Layer {
  std::array<std::vector<Vec<3, float>>, 2> means;
  std::vector<float> variance;  // of one half's mean

  // As far as the halves lie apart, about each vertex: two values alone would not tell.
  void learn_variance(const Neighbours& neighbours) {
    variance.resize(means[0].size());
    for (std::size_t v = 0; v < variance.size(); ++v) {
      float sum = 0;
      for (const std::uint32_t* u = neighbours.begin(v); u != neighbours.end(v); ++u) {
        sum += distance2(means[0][*u], means[1][*u]) / 2;
      }
      variance[v] = sum / static_cast<float>(neighbours.end(v) - neighbours.begin(v));
    }
  }

  void pass(const Neighbours& neighbours) {
    learn_variance(neighbours);
    const std::array<std::vector<Vec<3, float>>, 2> before = means;
    for (int half = 0; half < 2; ++half) {
      const std::vector<Vec<3, float>>& guide = before[1 - half];
      for (std::size_t v = 0; v < variance.size(); ++v) {
        Vec<3, float> sum(0);
        float weights = 0;
        for (const std::uint32_t* u = neighbours.begin(v); u != neighbours.end(v); ++u) {
          const float noise = tolerance * tolerance * (variance[v] + variance[*u]);
          const float apart = distance2(guide[v], guide[*u]);
          const float weight = apart > 0 ? std::exp(-apart / std::max(noise, 1e-30f)) : 1;
          sum += before[half][*u] * weight;
          weights += weight;
        }
        means[half][v] = sum / weights;
      }
    }
  }
};

}  // namespace

template <int D>
std::vector<Vec<3, float>> smooth(const FineMesh<D>& mesh, Halves halves, int passes,
                                  Progress& progress) {
  const Neighbours neighbours(mesh);
  const std::size_t n = mesh.vertices.size(), nodes = halves[0].size() / n;
  std::vector<Vec<3, float>> smoothed(halves[0].size());
  parallel_range(nodes, 1, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      Layer layer;
      for (int half = 0; half < 2; ++half) {
        const auto first = halves[half].begin() + static_cast<std::ptrdiff_t>(node * n);
        layer.means[half].assign(first, first + static_cast<std::ptrdiff_t>(n));
      }
      for (int i = 0; i < passes; ++i) layer.pass(neighbours);
      for (std::size_t v = 0; v < n; ++v) {
        smoothed[node * n + v] = (layer.means[0][v] + layer.means[1][v]) * 0.5f;
      }
    }
  });
  return smoothed;
}

template std::vector<Vec<3, float>> smooth(const FineMesh<2>&, Halves, int, Progress&);
template std::vector<Vec<3, float>> smooth(const FineMesh<3>&, Halves, int, Progress&);

}  // namespace leaflight
