// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "surface/marching_cubes.h"

namespace leaflight::test {

// Number of triangles that use each directed edge.
using EdgeCount = std::map<std::pair<int, int>, int>;

inline EdgeCount directed_edges(const IsosurfaceMesh& mesh) {
  EdgeCount edges;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  return edges;
}

// True if each edge is used as often in one direction as in the other.
inline bool closed(const IsosurfaceMesh& mesh) {
  const EdgeCount edges = directed_edges(mesh);
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    if (opposite == edges.end() || opposite->second != count) return false;
  }
  return true;
}

inline double signed_volume(const IsosurfaceMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

inline int euler_characteristic(const IsosurfaceMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& [edge, count] : directed_edges(mesh)) {
    edges.insert(std::minmax(edge.first, edge.second));
  }
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(mesh.triangles.size());
}

// Disjoint sets that can be merged.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  void join(int a, int b) {
    a = of(a), b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

// The connected parts of a mesh, and the closed lines that bound them.
struct Parts {
  int surfaces = 0, borders = 0;
};
inline Parts parts_of(const IsosurfaceMesh& mesh) {
  Groups surface(mesh.vertices.size()), border(mesh.vertices.size());
  std::set<int> on_border;
  const EdgeCount edges = directed_edges(mesh);
  for (const auto& [edge, count] : edges) {
    surface.join(edge.first, edge.second);
    if (edges.count({edge.second, edge.first})) continue;
    border.join(edge.first, edge.second);
    on_border.insert({edge.first, edge.second});
  }
  Parts parts;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
    parts.surfaces += surface.of(v) == v;
  for (const int v : on_border) parts.borders += border.of(v) == v;
  return parts;
}

// Expects a manifold: no directed edge is used twice, and no triangle twice or with a repeated
// corner. The triangles at each vertex form one fan.
inline void expect_manifold(const IsosurfaceMesh& mesh) {
  for (const auto& [edge, count] : directed_edges(mesh)) {
    ASSERT_EQ(count, 1) << "edge " << edge.first << ' ' << edge.second;
    ASSERT_NE(edge.first, edge.second);
  }
  std::set<std::array<std::int32_t, 3>> triangles;
  // Collect, for each vertex, the opposite edges of its triangles.
  std::vector<std::vector<std::pair<int, int>>> across(mesh.vertices.size());
  for (auto t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) across[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
    std::sort(t.begin(), t.end());
    ASSERT_TRUE(triangles.insert(t).second) << "twice: " << t[0] << ' ' << t[1] << ' ' << t[2];
  }
  for (std::size_t v = 0; v < across.size(); ++v) {
    ASSERT_FALSE(across[v].empty()) << "unused: " << v;
    std::map<int, int> next(across[v].begin(), across[v].end());
    std::set<int> starts;
    for (const auto& [a, b] : across[v]) starts.insert(a);
    for (const auto& [a, b] : across[v]) starts.erase(b);
    ASSERT_LE(starts.size(), 1u) << "fans that touch: " << v;
    int at = starts.empty() ? across[v][0].first : *starts.begin();
    std::size_t walked = 0;
    for (; walked < across[v].size() && next.count(at); ++walked) at = next[at];
    ASSERT_EQ(walked, across[v].size()) << "fans that touch: " << v;
    ASSERT_TRUE(!starts.empty() || at == across[v][0].first) << "fans that touch: " << v;
  }
}

}  // namespace leaflight::test
