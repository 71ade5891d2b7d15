// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/mesh_smoother.h"

#include <tbb/parallel_for.h>

namespace leaflight {

MeshSmoother::MeshSmoother(const VertexFans& fans, const std::vector<Vec<3, float>>& normals)
    : first_(normals.size() + 1, 0) {
  for (std::size_t v = 0; v < normals.size(); ++v) first_[v + 1] = first_[v] + fans.size(v);
  neighbours_.resize(first_.back());
  tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t v) {
    float sum = 1;
    for (std::size_t i = 0; i < fans.size(v); ++i) {
      // Each neighbour is the first of the others in one triangle.
      const std::int32_t other = fans.others(v, i)[0];
      const float cosine = std::max(0.0f, normals[v].dot(normals[other]));
      neighbours_[first_[v] + i] = {other, cosine * cosine};
      sum += cosine * cosine;
    }
    for (std::size_t n = first_[v]; n < first_[v + 1]; ++n) neighbours_[n].share /= sum;
  });
}

template <std::size_t Channels>
void MeshSmoother::smooth(std::vector<std::array<float, Channels>>& values, int steps) const {
  std::vector<std::array<float, Channels>> next(values.size());
  for (int step = 0; step < steps; ++step) {
    tbb::parallel_for(std::size_t{0}, values.size(), [&](std::size_t v) {
      std::array<float, Channels> sum{};
      float rest = 1;
      for (std::size_t n = first_[v]; n < first_[v + 1]; ++n) {
        const auto [other, share] = neighbours_[n];
        for (std::size_t k = 0; k < Channels; ++k) sum[k] += values[other][k] * share;
        rest -= share;
      }
      for (std::size_t k = 0; k < Channels; ++k) sum[k] += values[v][k] * rest;
      next[v] = sum;
    });
    values.swap(next);
  }
}

template void MeshSmoother::smooth(std::vector<std::array<float, 2>>&, int) const;
template void MeshSmoother::smooth(std::vector<std::array<float, 3>>&, int) const;
template void MeshSmoother::smooth(std::vector<std::array<float, 8>>&, int) const;

}  // namespace leaflight
