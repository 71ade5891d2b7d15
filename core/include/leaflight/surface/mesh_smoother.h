// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/math/vector.h"
#include "leaflight/surface/vertex_fans.h"

namespace leaflight {

// Averages over the neighbours on a mesh, as often as wished: after n steps about over sqrt(n / 2)
// edges. A neighbour counts by the square of its normal's cosine, and not at all beyond a right
// angle: nothing passes round the rim of a shell.
class MeshSmoother {
 public:
  // normals: unit, of the vertices.
  MeshSmoother(const VertexFans& fans, const std::vector<Vec<3, float>>& normals);

  // Smooths the values of the vertices, channel by channel.
  template <std::size_t Channels>
  void smooth(std::vector<std::array<float, Channels>>& values, int steps) const;

 private:
  struct Neighbour {
    std::int32_t vertex;
    float share;
  };
  std::vector<std::size_t> first_;  // of each vertex's neighbours, and the number of all
  std::vector<Neighbour> neighbours_;
};

}  // namespace leaflight
