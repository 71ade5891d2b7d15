// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/surface/marching_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fields.h"
#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

// Each vertex begins as many segments as it ends.
bool closed(const IsolineMesh& mesh) {
  std::vector<int> balance(mesh.vertices.size(), 0);
  for (const auto& [from, to] : mesh.segments) ++balance[from], --balance[to];
  return std::all_of(balance.begin(), balance.end(), [](int b) { return b == 0; });
}

// Counter-clockwise lines enclose a positive area.
double enclosed_area(const IsolineMesh& mesh) {
  double area = 0;
  for (const auto& [from, to] : mesh.segments) {
    const Vec<2, double> a(mesh.vertices[from]), b(mesh.vertices[to]);
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return area;
}

TEST(MarchingSquares, Circle) {
  const IsolineMesh mesh = contour(test::ball<2>(41), 0.7);
  EXPECT_TRUE(closed(mesh));
  EXPECT_EQ(mesh.vertices.size(), mesh.segments.size());
  // The outside is on the left, so the lines run clockwise around what is higher.
  EXPECT_NEAR(enclosed_area(mesh), -pi * 0.09, 1e-3);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec<2> p = Vec<2>(mesh.vertices[v]) - Vec<2>(0.5);
    EXPECT_NEAR(p.length(), 0.3, 1e-3);
    EXPECT_GT(p.normalized().dot(Vec<2>(mesh.normals[v])), 0.995);
  }
}

// Every sign pattern and both decisions occur here many times.
TEST(MarchingSquares, NoiseHasNoLooseEnds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const IsolineMesh mesh = contour(test::noise<2>(40, seed, -1.0), 0.5);
    EXPECT_GT(mesh.segments.size(), 500u);
    EXPECT_TRUE(closed(mesh));
    EXPECT_LT(enclosed_area(mesh), 0);
  }
}

TEST(MarchingSquares, MirroredAndMasked) {
  const Field<2> circle = test::ball<2>(41);
  std::vector<float> values(circle.values, circle.values + circle.voxels());
  Affine<2> mirror = circle.index_to_world;
  mirror.column[0] *= -1;
  EXPECT_NEAR(enclosed_area(contour(test::field_from<2>(values, circle.dims, mirror), 0.7)),
              -pi * 0.09, 1e-3);
  // A quarter of the circle is cut out.
  for (int y = 20; y < 41; ++y) {
    for (int x = 20; x < 41; ++x) values[y * 41 + x] = std::numeric_limits<float>::quiet_NaN();
  }
  const IsolineMesh mesh =
      contour(test::field_from<2>(values, circle.dims, circle.index_to_world), 0.7);
  EXPECT_FALSE(closed(mesh));
  EXPECT_EQ(mesh.vertices.size(), mesh.segments.size() + 1);
}

}  // namespace
}  // namespace leaflight
