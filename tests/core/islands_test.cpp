// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/islands.h"

#include <gtest/gtest.h>

#include "fields.h"
#include "meshes.h"
#include "surface/marching_cubes.h"

namespace leaflight {
namespace {

// Returns the isosurface of two balls with the radii 0.3 and 0.05.
IsosurfaceMesh large_and_small_ball() {
  const auto field = test::sampled<3>(41, [](const Vec3& x) {
    const double large = 0.3 - (x - Vec3(0.35)).length(), small = 0.05 - (x - Vec3(0.85)).length();
    return 0.5 + std::max(large, small);
  });
  return contour(field, 0.5);
}

LargeParts parts_of(const IsosurfaceMesh& mesh, float smallest) {
  return large_parts(mesh.vertices.data(), mesh.vertices.size(), mesh.triangles.data(),
                     mesh.triangles.size(), smallest);
}

TEST(Islands, SmallOnesGo) {
  const IsosurfaceMesh mesh = large_and_small_ball();
  const LargeParts parts = parts_of(mesh, 0.15f);
  IsosurfaceMesh previous;
  for (const std::int32_t v : parts.vertices) {
    previous.vertices.push_back(mesh.vertices[v]);
    EXPECT_NEAR((Vec3(mesh.vertices[v]) - Vec3(0.35)).length(), 0.3, 0.01);
  }
  previous.triangles = parts.triangles;
  EXPECT_TRUE(test::closed(previous));
  EXPECT_EQ(test::euler_characteristic(previous), 2);
  EXPECT_LT(previous.vertices.size(), mesh.vertices.size());
}

TEST(Islands, AllStayOrGoByTheirLength) {
  const IsosurfaceMesh mesh = large_and_small_ball();
  const LargeParts all = parts_of(mesh, 0.09f), none = parts_of(mesh, 0.7f);
  EXPECT_EQ(all.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(all.triangles, mesh.triangles);
  EXPECT_TRUE(none.vertices.empty() && none.triangles.empty());
}

}  // namespace
}  // namespace leaflight
