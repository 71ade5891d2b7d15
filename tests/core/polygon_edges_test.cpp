// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_edges.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "fields.h"
#include "surface/marching_cubes.h"

namespace leaflight {
namespace {

using Edge = std::array<std::int32_t, 2>;

struct Found {
  std::vector<Edge> vertices;
  std::vector<std::int32_t> corner_edge;
};

Found edges_of(const std::vector<std::int32_t>& corners, int sides, std::size_t vertices,
               const PolygonEdges::Wanted& wanted = {}) {
  const PolygonEdges edges(corners.data(), corners.size() / sides, sides, vertices, wanted);
  Found found{std::vector<Edge>(edges.count()), std::vector<std::int32_t>(edges.corners(), -1)};
  edges.visit(
      [&](std::int32_t edge, std::int32_t lower, std::int32_t other) {
        found.vertices[edge] = {lower, other};
      },
      [&](std::int32_t corner, std::int32_t edge) { found.corner_edge[corner] = edge; });
  return found;
}

// Compares the edges with those that a std::map finds.
void expect_edges_of(const std::vector<std::int32_t>& corners, int sides, std::size_t vertices) {
  const Found edges = edges_of(corners, sides, vertices);
  std::map<Edge, std::int32_t> numbers;
  const auto edge_from = [&](std::size_t corner) {
    const std::size_t first = corner - corner % sides;
    const auto [low, high] =
        std::minmax(corners[corner], corners[first + (corner + 1 - first) % sides]);
    return Edge{low, high};
  };
  for (std::size_t corner = 0; corner < corners.size(); ++corner) numbers[edge_from(corner)] = 0;
  std::vector<Edge> expected;
  for (auto& [edge, number] : numbers) {
    number = static_cast<std::int32_t>(expected.size());
    expected.push_back(edge);
  }
  EXPECT_EQ(edges.vertices, expected);
  ASSERT_EQ(edges.corner_edge.size(), corners.size());
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    EXPECT_EQ(edges.corner_edge[corner], numbers.at(edge_from(corner)));
  }
}

TEST(PolygonEdges, OfTwoQuads) {
  const std::vector<std::int32_t> corners{0, 1, 2, 3, 3, 2, 5, 4};
  const Found edges = edges_of(corners, 4, 6);
  const std::vector<Edge> expected{{0, 1}, {0, 3}, {1, 2}, {2, 3}, {2, 5}, {3, 4}, {4, 5}};
  EXPECT_EQ(edges.vertices, expected);
  EXPECT_EQ(edges.corner_edge, (std::vector<std::int32_t>{0, 2, 3, 1, 3, 4, 6, 5}));
}

TEST(PolygonEdges, OfAClosedSurface) {
  const IsosurfaceMesh mesh = contour(test::ball<3>(21), 0.7);
  std::vector<std::int32_t> corners;
  for (const auto& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  expect_edges_of(corners, 3, mesh.vertices.size());
  EXPECT_EQ(2 * edges_of(corners, 3, mesh.vertices.size()).vertices.size(), corners.size());
}

TEST(PolygonEdges, OfAnyPolygons) {
  std::mt19937 random(1);
  for (const int sides : {3, 4}) {
    // Use few vertices, so that many polygons share an edge and many edges share a vertex.
    for (const int vertices : {5, 40, 1000}) {
      std::uniform_int_distribution<std::int32_t> any(0, vertices - 1);
      std::vector<std::int32_t> corners(300 * sides);
      for (std::int32_t& corner : corners) corner = any(random);
      expect_edges_of(corners, sides, vertices);
    }
  }
}

TEST(PolygonEdges, LeavesOutUnwantedOnes) {
  const std::vector<std::int32_t> corners{0, 1, 2, 3, 3, 2, 5, 4};
  const auto wanted = [](std::int32_t lower, std::int32_t other) { return lower + other != 3; };
  const Found edges = edges_of(corners, 4, 6, wanted);
  EXPECT_EQ(edges.vertices, (std::vector<Edge>{{0, 1}, {2, 3}, {2, 5}, {3, 4}, {4, 5}}));
  EXPECT_EQ(edges.corner_edge, (std::vector<std::int32_t>{0, -1, 1, -1, 1, 2, 4, 3}));
}

TEST(PolygonEdges, OfNothing) {
  const Found edges = edges_of({}, 3, 0);
  EXPECT_TRUE(edges.vertices.empty() && edges.corner_edge.empty());
}

}  // namespace
}  // namespace leaflight
