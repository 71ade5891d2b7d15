// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/smooth_walls.h"

#include <algorithm>
#include <cmath>

#include "bake/walls/mesh_neighbors.h"
#include "base/parallel.h"

namespace leaflight {
namespace {

// Difference in standard deviations at which the weight of a vertex is 1/e.
constexpr float tolerance = 2;

float distance2(const Vec<3, float>& a, const Vec<3, float>& b) { return (a - b).length2() / 3; }

// Estimates the variance of one half's mean at each entry of a node. Pools the halves' differences
// over neighbors, because two values are too few.
std::vector<float> variances(const Halves& halves, const MeshNeighbors& neighbors,
                             std::size_t first, std::size_t vertices) {
  std::vector<float> variances(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    float sum = 0;
    for (const std::uint32_t* u = neighbors.begin(v); u != neighbors.end(v); ++u) {
      sum += distance2(halves[0][first + *u], halves[1][first + *u]) / 2;
    }
    variances[v] = sum / static_cast<float>(neighbors.end(v) - neighbors.begin(v));
  }
  return variances;
}

// One pass over an entry's neighbors, at its node and at adjacent nodes.
class Pass {
 public:
  Pass(const Halves& before, const MeshNeighbors& neighbors, std::size_t vertices,
       Progress& progress)
      : before_(before),
        neighbors_(neighbors),
        vertices_(vertices),
        nodes_(before[0].size() / vertices),
        variance_(nodes_) {
    parallel_each(nodes_, 1, progress, [&](std::size_t node) {
      variance_[node] = variances(before, neighbors, node * vertices, vertices);
    });
  }

  Vec<3, float> mean(int half, std::size_t node, std::size_t v) const {
    Weighted sum;
    const std::size_t e = node * vertices_ + v;
    const std::uint32_t *begin = neighbors_.begin(v), *end = neighbors_.end(v);
    for (const std::uint32_t* u = begin; u != end; ++u) {
      add(half, e, variance_[node][v], node * vertices_ + *u, variance_[node][*u], sum);
    }
    if (node > 0) {
      add(half, e, variance_[node][v], e - vertices_, variance_[node - 1][v], sum);
    }
    if (node + 1 < nodes_) {
      add(half, e, variance_[node][v], e + vertices_, variance_[node + 1][v], sum);
    }
    return sum.value / sum.weight;
  }

 private:
  struct Weighted {
    Vec<3, float> value{0};
    float weight = 0;
  };
  void add(int half, std::size_t e, float variance, std::size_t other, float its_variance,
           Weighted& sum) const {
    const std::vector<Vec<3, float>>& guide = before_[1 - half];
    const float noise = tolerance * tolerance * (variance + its_variance);
    const float difference = distance2(guide[e], guide[other]);
    // Use double precision: standard libraries round a float's exponential differently.
    const double exponent = -difference / std::max(noise, 1e-30f);
    const float weight = difference > 0 ? static_cast<float>(std::exp(exponent)) : 1;
    sum.value += before_[half][other] * weight;
    sum.weight += weight;
  }

  const Halves& before_;
  const MeshNeighbors& neighbors_;
  std::size_t vertices_, nodes_;
  std::vector<std::vector<float>> variance_;  // by node
};

}  // namespace

std::vector<Vec<3, float>> mean(const Halves& halves) {
  std::vector<Vec<3, float>> mean(halves[0].size());
  for (std::size_t e = 0; e < mean.size(); ++e) mean[e] = (halves[0][e] + halves[1][e]) * 0.5f;
  return mean;
}

template <int D>
Halves smooth(const FineMesh<D>& mesh, Halves halves, int passes, Progress& progress) {
  const std::size_t n = mesh.vertices.size(), nodes = halves[0].size() / n;
  const MeshNeighbors neighbors(n, mesh.facets);
  for (int i = 0; i < passes; ++i) {
    const Halves before = halves;
    const Pass pass(before, neighbors, n, progress);
    parallel_each(nodes, 1, progress, [&](std::size_t node) {
      for (int half = 0; half < 2; ++half) {
        for (std::size_t v = 0; v < n; ++v) halves[half][node * n + v] = pass.mean(half, node, v);
      }
    });
  }
  return halves;
}

template Halves smooth(const FineMesh<2>&, Halves, int, Progress&);
template Halves smooth(const FineMesh<3>&, Halves, int, Progress&);

}  // namespace leaflight
