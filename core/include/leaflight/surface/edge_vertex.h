// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/field/field.h"

namespace leaflight {

// Where a leaf crosses an edge of the grid: the vertices of isosurfaces and isolines.
template <int D>
struct EdgeVertex {
  Vec<D, float> position;  // world
  Vec<D, float> normal;  // world, unit, of the shading gradient, outward; zero where that vanishes
};

// The edge goes from a voxel to the next along an axis; their values lie on different sides of the
// isovalue.
template <int D>
EdgeVertex<D> edge_vertex(const Field<D>& field, const Index<D>& voxel, int axis, double isovalue);

}  // namespace leaflight
