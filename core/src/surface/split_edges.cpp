// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/split_edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "field/shading_gradient.h"
#include "surface/polygon_edges.h"
#include "surface/project.h"

namespace leaflight {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// The midpoint vertices of a triangle's edges, from each corner to the next; or unsplit.
using Middles = std::array<std::int32_t, 3>;
constexpr std::int32_t unsplit = -1;

int cut_edges(const Middles& middle) {
  return 3 - static_cast<int>(std::count(middle.begin(), middle.end(), unsplit));
}

// Writes the parts of a triangle, one more than its split edges.
void write_parts(const Triangle& t, const Middles& middle, Triangle* parts) {
  const int cut = cut_edges(middle);
  if (cut == 0) {
    *parts = t;
    return;
  }
  if (cut == 3) {
    for (int i = 0; i < 3; ++i) *parts++ = {t[i], middle[i], middle[(i + 2) % 3]};
    *parts = middle;
    return;
  }
  // Start at the corner before the only split edge, or after the only unsplit one.
  int first = 0;
  for (int i = 0; i < 3; ++i) {
    if (cut == 1 && middle[i] >= 0) first = i;
    if (cut == 2 && middle[i] < 0) first = (i + 1) % 3;
  }
  const std::int32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
  const std::int32_t ab = middle[first], bc = middle[(first + 1) % 3];
  if (cut == 1) {
    *parts++ = {a, ab, c};
    *parts = {ab, b, c};
  } else {
    *parts++ = {ab, b, bc};
    *parts++ = {a, ab, bc};
    *parts = {a, bc, c};
  }
}

// Returns the point of the isosurface nearest to the midpoint of an edge. Returns the midpoint if
// the isosurface is too far away, as in a tunnel that the mesh does not follow.
Vec3 middle_of(const Field<3>& field, double isovalue, const Vec3& a, const Vec3& b) {
  const Vec3 middle = (a + b) * 0.5;
  Vec3 found = project_to_isosurface(field, middle, isovalue);
  if (field.ramp != nullptr) {
    const Vec3 index = field.world_to_index.point(found);
    found = field.index_to_world.point(flat_on_cut(field, index, isovalue));
  }
  return (found - middle).length() <= 0.25 * (b - a).length() ? found : middle;
}

}  // namespace

IsosurfaceMesh split_edges(const Field<3>& field, double isovalue, const IsosurfaceMesh& mesh,
                           const std::function<bool(std::int32_t, std::int32_t)>& wanted) {
  const std::size_t old = mesh.vertices.size();
  const bool normals = !mesh.normals.empty();
  const auto vertex = [&](std::int32_t v) { return Vec3(mesh.vertices[v]); };
  const PolygonEdges edges(reinterpret_cast<const std::int32_t*>(mesh.triangles.data()),
                           mesh.triangles.size(), 3, old, wanted);
  // Copy the old vertices, and add one for each split edge.
  IsosurfaceMesh result;
  result.vertices.resize(old + edges.count());
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), result.vertices.begin());
  if (normals) {
    result.normals.resize(old + edges.count());
    std::copy(mesh.normals.begin(), mesh.normals.end(), result.normals.begin());
  }
  std::vector<Middles> middles(mesh.triangles.size(), {unsplit, unsplit, unsplit});
  edges.visit(
      [&](std::int32_t edge, std::int32_t lower, std::int32_t other) {
        const Vec3 middle = middle_of(field, isovalue, vertex(lower), vertex(other));
        result.vertices[old + edge] = Vec<3, float>(middle);
        if (!normals) return;
        result.normals[old + edge] =
            Vec<3, float>(shading_normal(field, field.world_to_index.point(middle)));
      },
      [&](std::int32_t corner, std::int32_t edge) {
        middles[corner / 3][corner % 3] = static_cast<std::int32_t>(old) + edge;
      });
  // Process pieces in the order of the triangles.
  constexpr std::size_t piece = 4096;
  std::vector<std::size_t> first((mesh.triangles.size() + piece - 1) / piece + 1, 0);
  const auto for_each_triangle = [&](const auto& visit) {
    tbb::parallel_for(std::size_t{1}, first.size(), [&](std::size_t p) {
      const std::size_t end = std::min(p * piece, mesh.triangles.size());
      for (std::size_t t = (p - 1) * piece; t < end; ++t) visit(p, t);
    });
  };
  // Count the parts of each piece of the triangles, then write them.
  for_each_triangle([&](std::size_t p, std::size_t t) { first[p] += 1 + cut_edges(middles[t]); });
  std::partial_sum(first.begin(), first.end(), first.begin());
  result.triangles.resize(first.back());
  for_each_triangle([&](std::size_t p, std::size_t t) {
    std::size_t& next = first[p - 1];
    write_parts(mesh.triangles[t], middles[t], result.triangles.data() + next);
    next += 1 + cut_edges(middles[t]);
  });
  return result;
}

}  // namespace leaflight
