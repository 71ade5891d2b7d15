// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/smooth_walls.h"

#include <algorithm>
#include <cmath>

#include "bake/walls/mesh_neighbours.h"
#include "math/parallel.h"

namespace leaflight {
namespace {

// In standard deviations of a difference: a vertex that differs so much has the weight 1/e.
constexpr float tolerance = 2;

float distance2(const Vec<3, float>& a, const Vec<3, float>& b) { return (a - b).length2() / 3; }

// One node's vertices, of both halves.
struct Layer {
  std::array<std::vector<Vec<3, float>>, 2> means;
  std::vector<float> variance;  // of one half's mean

  // From the halves' differences about each vertex: two values alone are no estimate.
  void learn_variance(const MeshNeighbours& neighbours) {
    variance.resize(means[0].size());
    for (std::size_t v = 0; v < variance.size(); ++v) {
      float sum = 0;
      for (const std::uint32_t* u = neighbours.begin(v); u != neighbours.end(v); ++u) {
        sum += distance2(means[0][*u], means[1][*u]) / 2;
      }
      variance[v] = sum / static_cast<float>(neighbours.end(v) - neighbours.begin(v));
    }
  }

  void pass(const MeshNeighbours& neighbours) {
    learn_variance(neighbours);
    const std::array<std::vector<Vec<3, float>>, 2> before = means;
    for (int half = 0; half < 2; ++half) {
      const std::vector<Vec<3, float>>& guide = before[1 - half];
      for (std::size_t v = 0; v < variance.size(); ++v) {
        Vec<3, float> sum(0);
        float weights = 0;
        for (const std::uint32_t* u = neighbours.begin(v); u != neighbours.end(v); ++u) {
          const float noise = tolerance * tolerance * (variance[v] + variance[*u]);
          const float difference = distance2(guide[v], guide[*u]);
          const float weight = difference > 0 ? std::exp(-difference / std::max(noise, 1e-30f)) : 1;
          sum += before[half][*u] * weight;
          weights += weight;
        }
        means[half][v] = sum / weights;
      }
    }
  }
};

}  // namespace

std::vector<Vec<3, float>> mean(const Halves& halves) {
  std::vector<Vec<3, float>> mean(halves[0].size());
  for (std::size_t e = 0; e < mean.size(); ++e) mean[e] = (halves[0][e] + halves[1][e]) * 0.5f;
  return mean;
}

template <int D>
Halves smooth(const FineMesh<D>& mesh, Halves halves, int passes, Progress& progress) {
  const MeshNeighbours neighbours(mesh.vertices.size(), mesh.facets);
  const std::size_t n = mesh.vertices.size(), nodes = halves[0].size() / n;
  parallel_range(nodes, 1, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      Layer layer;
      for (int half = 0; half < 2; ++half) {
        const auto first = halves[half].begin() + static_cast<std::ptrdiff_t>(node * n);
        layer.means[half].assign(first, first + static_cast<std::ptrdiff_t>(n));
      }
      for (int i = 0; i < passes; ++i) layer.pass(neighbours);
      for (int half = 0; half < 2; ++half) {
        const auto first = halves[half].begin() + static_cast<std::ptrdiff_t>(node * n);
        std::copy(layer.means[half].begin(), layer.means[half].end(), first);
      }
    }
  });
  return halves;
}

template Halves smooth(const FineMesh<2>&, Halves, int, Progress&);
template Halves smooth(const FineMesh<3>&, Halves, int, Progress&);

}  // namespace leaflight
