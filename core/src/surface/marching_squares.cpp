// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/marching_squares.h"

#include <cmath>
#include <unordered_map>

#include "leaflight/surface/cell_polygons.h"
#include "leaflight/surface/edge_vertex.h"

namespace leaflight {
namespace {

// The corners of a cell counter-clockwise, as offsets along x and y. Edge i of the cell goes from
// corner i to the next.
constexpr std::array<Index<2>, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

class Contour {
 public:
  Contour(const Field<2>& field, double isovalue) : field_(field), isovalue_(isovalue) {}

  IsolineMesh run() {
    constexpr int brick_size = 1 << IntervalPyramid<2>::log2_brick;
    const auto& bricks = field_.pyramid.levels[0];
    for_each_index<2>({}, bricks.dims, [&](const Index<2>& brick) {
      if (!bricks.at(brick).crossed_by(isovalue_)) return;
      Index<2> low, high;
      for (int a = 0; a < 2; ++a) {
        low[a] = brick[a] * brick_size;
        high[a] = std::min(low[a] + brick_size, field_.dims[a] - 1);
      }
      for_each_index<2>(low, high, [&](const Index<2>& cell) { connect(cell); });
    });
    return std::move(mesh_);
  }

 private:
  void connect(const Index<2>& cell) {
    std::array<double, 4> g;
    FaceSigns above;
    for (int i = 0; i < 4; ++i) {
      const Index<2> voxel{cell[0] + corners[i][0], cell[1] + corners[i][1]};
      const double h = field_.values[field_.offset(voxel)];
      if (std::isnan(h)) return;
      g[i] = h - isovalue_;
      above[i] = h >= isovalue_;
    }
    const bool joined = joined_across(g, above);
    for (int leaving = 0; leaving < 4; ++leaving) {
      if (!above[leaving] || above[(leaving + 1) % 4]) continue;
      std::array<std::int32_t, 2> segment{vertex(cell, returning_edge(above, leaving, joined)),
                                          vertex(cell, leaving)};
      // The outside is on the left in index coordinates; a mirroring transform turns that around.
      if (mirrored_) std::swap(segment[0], segment[1]);
      mesh_.segments.push_back(segment);
    }
  }

  std::int32_t vertex(const Index<2>& cell, int edge) {
    const Index<2>&a = corners[edge], &b = corners[(edge + 1) % 4];
    const Index<2> voxel{cell[0] + std::min(a[0], b[0]), cell[1] + std::min(a[1], b[1])};
    const int axis = a[0] == b[0];
    const auto [found, added] =
        number_.try_emplace(2 * field_.offset(voxel) + axis, mesh_.vertices.size());
    if (added) {
      const EdgeVertex<2> v = edge_vertex(field_, voxel, axis, isovalue_);
      mesh_.vertices.push_back(v.position);
      mesh_.normals.push_back(v.normal);
    }
    return found->second;
  }

  const Field<2>& field_;
  const double isovalue_;
  const bool mirrored_ = determinant(field_.index_to_world) < 0;
  std::unordered_map<std::size_t, std::int32_t> number_;  // of the vertex on an edge of the grid
  IsolineMesh mesh_;
};

}  // namespace

IsolineMesh contour(const Field<2>& field, double isovalue) {
  return Contour(field, isovalue).run();
}

}  // namespace leaflight
