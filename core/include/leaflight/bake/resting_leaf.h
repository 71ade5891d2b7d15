// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/surface/vertex_fans.h"
#include "leaflight/trace/scene_tracer.h"

namespace leaflight {

// One side of the leaf of a volume, and its mesh.
struct RestingLeaf {
  int volume;
  double c;    // the leaf coordinate
  bool above;  // the inner side
  VertexFans fans;
  std::vector<Vec<3, float>> vertices;  // world
};

// The points of the leaf that a vertex's samples take in turn. They lie about it on its triangles:
// at the vertex itself, on an edge of the grid, the traced surface has a kink. Of kind none where
// no leaf passes.
using VertexSpots = std::array<SurfacePoint<3>, 4>;
VertexSpots spots_of(const SceneTracer<3>& tracer, const RestingLeaf& leaf, std::size_t vertex);

}  // namespace leaflight
