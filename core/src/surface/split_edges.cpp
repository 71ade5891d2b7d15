// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/split_edges.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "leaflight/surface/project.h"

namespace leaflight {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// The lower vertex first.
using Edge = std::array<std::int32_t, 2>;
Edge edge_of(const Triangle& triangle, int corner) {
  const std::int32_t a = triangle[corner], b = triangle[(corner + 1) % 3];
  return {std::min(a, b), std::max(a, b)};
}

// The triangles into which one falls whose edges, from each corner to the next, have these middles;
// -1: none.
void append_parts(const Triangle& t, const std::array<std::int32_t, 3>& middle,
                  std::vector<Triangle>& parts) {
  const auto cut = 3 - std::count(middle.begin(), middle.end(), -1);
  if (cut == 0) {
    parts.push_back(t);
    return;
  }
  if (cut == 3) {
    for (int i = 0; i < 3; ++i) parts.push_back({t[i], middle[i], middle[(i + 2) % 3]});
    parts.push_back(middle);
    return;
  }
  // From the corner before the only edge that is cut, or after the only one that is not.
  int first = 0;
  for (int i = 0; i < 3; ++i) {
    if (cut == 1 && middle[i] >= 0) first = i;
    if (cut == 2 && middle[i] < 0) first = (i + 1) % 3;
  }
  const std::int32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
  const std::int32_t ab = middle[first], bc = middle[(first + 1) % 3];
  if (cut == 1) {
    parts.push_back({a, ab, c});
    parts.push_back({ab, b, c});
  } else {
    parts.push_back({ab, b, bc});
    parts.push_back({a, ab, bc});
    parts.push_back({a, bc, c});
  }
}

// The point of the leaf next to the middle of an edge; the middle itself where the leaf is farther
// away than a part of the edge can reach, as in a tunnel that the mesh does not follow.
Vec3 middle_of(const Field<3>& field, double isovalue, const Vec3& a, const Vec3& b) {
  const Vec3 middle = (a + b) * 0.5, found = project_to_leaf(field, middle, isovalue);
  return (found - middle).length() <= 0.25 * (b - a).length() ? found : middle;
}

}  // namespace

IsosurfaceMesh split_edges(const Field<3>& field, double isovalue, const IsosurfaceMesh& mesh,
                           const std::function<bool(const Vec3&)>& wanted) {
  const auto ends = [&](const Edge& edge) {
    return std::array<Vec3, 2>{Vec3(mesh.vertices[edge[0]]), Vec3(mesh.vertices[edge[1]])};
  };
  std::vector<Edge> edges(3 * mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    const Edge edge = edge_of(mesh.triangles[i / 3], static_cast<int>(i % 3));
    const auto [a, b] = ends(edge);
    const bool keep = wanted(field.world_to_index.point((a + b) * 0.5));
    edges[i] = keep ? edge : Edge{-1, -1};
  });
  tbb::parallel_sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (!edges.empty() && edges.front()[0] < 0) edges.erase(edges.begin());

  IsosurfaceMesh result;
  const std::size_t old = mesh.vertices.size();
  result.vertices = mesh.vertices;
  result.normals = mesh.normals;
  result.vertices.resize(old + edges.size());
  result.normals.resize(old + edges.size());
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    const auto [a, b] = ends(edges[i]);
    const Vec3 middle = middle_of(field, isovalue, a, b);
    result.vertices[old + i] = Vec<3, float>(middle);
    result.normals[old + i] =
        Vec<3, float>(shading_normal(field, field.world_to_index.point(middle)));
  });
  for (const Triangle& triangle : mesh.triangles) {
    std::array<std::int32_t, 3> middle;
    for (int corner = 0; corner < 3; ++corner) {
      const Edge edge = edge_of(triangle, corner);
      const auto found = std::lower_bound(edges.begin(), edges.end(), edge);
      const bool cut = found != edges.end() && *found == edge;
      middle[corner] =
          cut ? static_cast<std::int32_t>(old + static_cast<std::size_t>(found - edges.begin()))
              : -1;
    }
    append_parts(triangle, middle, result.triangles);
  }
  return result;
}

}  // namespace leaflight
