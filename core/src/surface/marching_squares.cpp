// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/marching_squares.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "leaflight/surface/crossed_edges.h"

namespace leaflight {
namespace {

using Segment = std::array<std::int32_t, 2>;

// The corners counter-clockwise, numbered as in CellCorners, and the edge from each to the next.
constexpr std::array<int, 4> ring{0, 1, 3, 2};
struct RingEdge {
  int axis;
  int corner;  // its lower end
};
constexpr std::array<RingEdge, 4> ring_edges{{{0, 0}, {1, 1}, {0, 2}, {1, 0}}};

// Whether the two higher corners of an alternating square are connected across it: the saddle of
// the bilinear interpolant is above. h == c counts as above, hence >=.
bool joined(const std::array<double, 4>& g, bool first_above) {
  const double even = g[0] * g[3], odd = g[1] * g[2];
  return first_above ? even >= odd : odd >= even;
}

void cell_segments(const Field<2>& field, double isovalue, const CrossedEdges<2>& edges,
                   const Index<2>& cell, bool mirrored, std::vector<Segment>& segments) {
  CellCorners<2> corners = load_corners(field, cell);
  std::array<bool, 4> above;
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    if (std::isnan(corners.h[i])) return;
    above[i] = corners.h[i] >= isovalue;
    count += above[i];
    corners.h[i] -= isovalue;
  }
  if (count == 0 || count == 4) return;
  const auto vertex = [&](int i) {
    const RingEdge& e = ring_edges[i];
    return edges.number({cell[0] + (e.corner & 1), cell[1] + (e.corner >> 1)}, e.axis);
  };
  const auto rises = [&](int i) { return !above[ring[i]] && above[ring[(i + 1) % 4]]; };
  const bool alternating = count == 2 && above[0] == above[3];
  // The line leaves through an edge at which the ring falls. It came in, around the run above that
  // ends there, through the edge before it at which the ring rises; or, if the higher corners are
  // joined, around the run below that begins there, through the one after it.
  const int step = alternating && joined(corners.h, above[0]) ? 1 : 3;
  for (int i = 0; i < 4; ++i) {
    if (!above[ring[i]] || above[ring[(i + 1) % 4]]) continue;
    int from = (i + step) % 4;
    while (!rises(from)) from = (from + step) % 4;
    Segment segment{vertex(from), vertex(i)};
    if (mirrored) std::swap(segment[0], segment[1]);
    segments.push_back(segment);
  }
}

}  // namespace

IsolineMesh contour(const Field<2>& field, double isovalue) {
  const CrossedEdges<2> edges(field, isovalue);
  IsolineMesh mesh;
  edges.place(mesh.vertices, mesh.normals);
  std::vector<std::vector<Segment>> pieces(edges.bricks().size());
  // Outside is on the left in index coordinates; a mirroring transform turns that around.
  const bool mirrored = determinant(field.index_to_world) < 0;
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t p) {
    edges.for_each_cell(edges.bricks()[p], [&](const Index<2>& cell) {
      cell_segments(field, isovalue, edges, cell, mirrored, pieces[p]);
    });
  });
  for (const auto& piece : pieces) {
    mesh.segments.insert(mesh.segments.end(), piece.begin(), piece.end());
  }
  if (field.masked) drop_unused_vertices(mesh.vertices, mesh.normals, mesh.segments);
  return mesh;
}

}  // namespace leaflight
