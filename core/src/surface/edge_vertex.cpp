// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/edge_vertex.h"

namespace leaflight {

template <int D>
EdgeVertex<D> edge_vertex(const Field<D>& field, const Index<D>& voxel, int axis, double isovalue) {
  Index<D> next = voxel;
  ++next[axis];
  // On different sides, so they differ.
  const double low = field.values[field.offset(voxel)], high = field.values[field.offset(next)];
  Vec<D> position = to_vector<D>(voxel);
  position[axis] += (isovalue - low) / (high - low);
  const Vec<D> gradient =
      field.world_to_index.pull_back_gradient(shading_gradient(field, locate(field, position)));
  const double length = gradient.length();
  return {Vec<D, float>(field.index_to_world.point(position)),
          length > 0 ? Vec<D, float>(gradient * (-1 / length)) : Vec<D, float>(0)};
}

template EdgeVertex<2> edge_vertex<2>(const Field<2>&, const Index<2>&, int, double);
template EdgeVertex<3> edge_vertex<3>(const Field<3>&, const Index<3>&, int, double);

}  // namespace leaflight
