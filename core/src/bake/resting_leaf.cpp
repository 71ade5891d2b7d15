// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/resting_leaf.h"

namespace leaflight {
namespace {

// How far a spot lies towards each of the two other corners of a triangle.
constexpr double reach = 0.125;

// The point of the leaf next to a point of its mesh (world), by Newton's method; that point itself
// where the leaf is more than a voxel away.
CellPoint<3> on_leaf(const Field<3>& field, const Vec3& world, double isovalue) {
  CellPoint<3> point = locate(field, field.world_to_index.point(world));
  for (int i = 0; i < 3; ++i) {
    const CellCorners<3> corners = load_corners(field, point.cell);
    const Vec3 gradient = geometric_gradient(corners, point.local);
    const double rest = isovalue - interpolate(corners, point.local);
    if (!(rest * rest < gradient.length2())) break;
    point = locate(field, point.index_position() + gradient * (rest / gradient.length2()));
  }
  return point;
}

}  // namespace

VertexSpots spots_of(const SceneTracer<3>& tracer, const RestingLeaf& leaf, std::size_t vertex) {
  const Volume<3>& volume = tracer.scene().volumes[leaf.volume];
  const double isovalue = volume.isovalue(leaf.c);
  const Vec3 middle(leaf.vertices[vertex]);
  VertexSpots found;
  for (std::size_t i = 0; i < found.size(); ++i) {
    Vec3 position = middle;
    if (leaf.fans.size(vertex) > 0) {
      const std::size_t triangle = i * leaf.fans.size(vertex) / found.size();
      for (const std::int32_t other : leaf.fans.others(vertex, triangle)) {
        position += (Vec3(leaf.vertices[other]) - middle) * reach;
      }
    }
    const CellPoint<3> point = on_leaf(volume.field, position, isovalue);
    found[i] = tracer.leaf_point(leaf.volume, point, leaf.c, leaf.above);
  }
  return found;
}

}  // namespace leaflight
