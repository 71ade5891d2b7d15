// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/marching_squares.h"

#include <tbb/parallel_for.h>

#include "field/shading_gradient.h"
#include "surface/crossed_edges.h"

namespace leaflight {
namespace {

using Segment = std::array<std::int32_t, 2>;

// The corners counter-clockwise, numbered as in CellCorners, and the edge from each to the next.
constexpr std::array<int, 4> ring{0, 1, 3, 2};
struct RingEdge {
  int axis;
  int corner;  // lower end
};
constexpr std::array<RingEdge, 4> ring_edges{{{0, 0}, {1, 1}, {0, 2}, {1, 0}}};

// True if the two higher corners of an alternating square are connected: the saddle of the bilinear
// interpolant is above. h == c counts as above, hence >=.
bool joined(const std::array<double, 4>& g, bool first_above) {
  const double even = g[0] * g[3], odd = g[1] * g[2];
  return first_above ? even >= odd : odd >= even;
}

void cell_segments(const CrossedEdges<2>& edges, const BrickValues<2>& values, int bit,
                   bool mirrored, std::vector<Segment>& segments) {
  const Index<2> cell = values.voxel(bit);
  const unsigned corners = values.corners_above(bit);
  const auto above = [&](int corner) { return ((corners >> corner) & 1u) != 0; };
  const auto vertex = [&](int i) {
    const RingEdge& e = ring_edges[i];
    return edges.number({cell[0] + (e.corner & 1), cell[1] + (e.corner >> 1)}, e.axis);
  };
  const auto rises = [&](int i) { return !above(ring[i]) && above(ring[(i + 1) % 4]); };
  const bool alternating = above(0) == above(3) && above(1) == above(2) && above(0) != above(1);
  CellCorners<2> g = load_corners(edges.field(), cell);
  for (double& h : g.h) h -= edges.isovalue();
  // The line leaves through an edge where the ring falls. If the higher corners are separate, it
  // came through the previous rising edge, around the run above. If they are joined, it came
  // through the next rising edge, around the run below.
  const int step = alternating && joined(g.h, above(0)) ? 1 : 3;
  for (int i = 0; i < 4; ++i) {
    if (!above(ring[i]) || above(ring[(i + 1) % 4])) continue;
    int from = (i + step) % 4;
    while (!rises(from)) from = (from + step) % 4;
    Segment segment{vertex(from), vertex(i)};
    if (mirrored) std::swap(segment[0], segment[1]);
    segments.push_back(segment);
  }
}

}  // namespace

IsolineMesh contour(const Field<2>& field, double isovalue) {
  CrossedEdges<2> edges(field, isovalue);
  edges.mark();
  IsolineMesh mesh;
  mesh.vertices.resize(edges.count());
  mesh.normals.resize(edges.count());
  std::vector<std::vector<Segment>> pieces(edges.bricks().size());
  // The outside is on the left in index coordinates; a mirroring transform reverses this.
  const bool mirrored = determinant(field.index_to_world) < 0;
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t p) {
    const auto& brick = edges.bricks()[p];
    const BrickValues<2> values = load_brick(field, brick.brick, isovalue);
    std::int64_t v = brick.first;
    for (int axis = 0; axis < 2; ++axis) {
      for_each_bit(brick.edges[axis], [&](int bit) {
        const Vec<2> position = edges.position(values, axis, bit);
        mesh.vertices[v] = Vec<2, float>(field.index_to_world.point(position));
        mesh.normals[v++] = Vec<2, float>(shading_normal(field, position));
      });
    }
    for_each_bit(values.crossed_cells(),
                 [&](int bit) { cell_segments(edges, values, bit, mirrored, pieces[p]); });
  });
  for (const auto& piece : pieces) {
    mesh.segments.insert(mesh.segments.end(), piece.begin(), piece.end());
  }
  if (field.masked) {
    drop_unused_vertices(mesh.vertices, mesh.normals, mesh.segments);
  }
  return mesh;
}

}  // namespace leaflight
