// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/marching_cubes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/sampling.h"
#include "fields.h"
#include "meshes.h"
#include "surface/split_edges.h"

namespace leaflight {
namespace {

using test::closed;
using test::euler_characteristic;
using test::signed_volume;

TEST(MarchingCubes, Sphere) {
  const Field<3> field = test::ball<3>(41);
  const IsosurfaceMesh mesh = contour(field, 0.7);
  EXPECT_TRUE(closed(mesh));
  EXPECT_EQ(euler_characteristic(mesh), 2);
  // An inscribed polyhedron lacks about (voxel / radius)^2 of the volume.
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3 * pi * 0.027, 8e-4);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 p = Vec3(mesh.vertices[v]) - Vec3(0.5);
    EXPECT_NEAR(p.length(), 0.3, 1e-3);
    EXPECT_GT(p.normalized().dot(Vec3(mesh.normals[v])), 0.995);
  }
}

TEST(MarchingCubes, Torus) {
  const IsosurfaceMesh mesh = contour(test::torus(50), 0.9);
  EXPECT_TRUE(closed(mesh));
  EXPECT_EQ(euler_characteristic(mesh), 0);
  EXPECT_NEAR(signed_volume(mesh), 2 * pi * pi * 0.25 * 0.01, 1e-3);
}

TEST(MarchingCubes, MirroredTransformKeepsOutwardOrientation) {
  Field<3> field = test::ball<3>(21);
  Affine<3> mirrored = field.index_to_world;
  mirrored.column[0] = -mirrored.column[0];
  const auto copy = make_field<3>(field.values, field.dims, mirrored, field.owner);
  const IsosurfaceMesh mesh = contour(copy, 0.7);
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3 * pi * 0.027, 3.2e-3);
}

TEST(MarchingCubes, MaskedCellsLeaveAHole) {
  const Field<3> whole = test::ball<3>(21);
  std::vector<float> values = test::values_of(whole);
  for (int z = 0; z < 21; ++z) values[whole.offset({10, 10, z})] = std::nanf("");
  const auto field = test::field_from<3>(values, whole.dims, whole.index_to_world);
  const IsosurfaceMesh mesh = contour(field, 0.7);
  EXPECT_LT(mesh.triangles.size(), contour(whole, 0.7).triangles.size());
  EXPECT_FALSE(closed(mesh));
  std::set<int> used;
  for (const auto& t : mesh.triangles) used.insert(t.begin(), t.end());
  EXPECT_EQ(used.size(), mesh.vertices.size());
}

TEST(MarchingCubes, NothingOutsideTheData) {
  EXPECT_TRUE(contour(test::ball<3>(9), 5.0).triangles.empty());
}

// Split edges on a part of the surface only, so that triangles have 0, 1, 2 or 3 split edges.
TEST(SplitEdges, LeavesNoCracksAndFollowsTheIsosurface) {
  const Field<3> field = test::ball<3>(21);
  const IsosurfaceMesh mesh = contour(field, 0.7);
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {
    const auto wanted = [&](std::int32_t a, std::int32_t b) {
      const Vec3 middle = (Vec3(mesh.vertices[a]) + Vec3(mesh.vertices[b])) * 0.5;
      const double x = 2e5 * (middle.x + 0.37 * middle.y + 0.71 * middle.z);
      return x - std::floor(x) < share;
    };
    const IsosurfaceMesh split = split_edges(field, 0.7, mesh, wanted);
    ASSERT_TRUE(closed(split)) << share;
    EXPECT_EQ(euler_characteristic(split), 2);
    const auto edges = 3 * mesh.triangles.size() / 2;
    const auto cut = split.vertices.size() - mesh.vertices.size();
    EXPECT_NEAR(static_cast<double>(cut) / static_cast<double>(edges), share, 0.03);
    EXPECT_EQ(split.triangles.size(), mesh.triangles.size() + 2 * cut);
    for (std::size_t v = mesh.vertices.size(); v < split.vertices.size(); ++v) {
      const Vec3 p(split.vertices[v]);
      const CellPoint<3> at = locate(field, field.world_to_index.point(p));
      ASSERT_NEAR(interpolate(load_corners(field, at.cell), at.local), 0.7, 1e-5);
      ASSERT_GT((p - Vec3(0.5)).normalized().dot(Vec3(split.normals[v])), 0.99);
    }
    // The isosurface bulges beyond the chords, so the volume grows.
    const double gained = signed_volume(split) - signed_volume(mesh);
    EXPECT_GE(gained, share * 1e-5) << share;
    EXPECT_LE(gained, 4.0 / 3 * pi * 0.027 - signed_volume(mesh)) << share;
  }
}

TEST(SplitEdges, LeavesNoCracksInNoise) {
  const Field<3> field = test::noise<3>(12, 5, -1.0);
  const IsosurfaceMesh mesh = contour(field, 0.5);
  ASSERT_TRUE(closed(mesh));
  const auto wanted = [&](std::int32_t a, std::int32_t b) {
    return mesh.vertices[a].x + mesh.vertices[b].x < 1;
  };
  const IsosurfaceMesh split = split_edges(field, 0.5, mesh, wanted);
  EXPECT_TRUE(closed(split));
  EXPECT_GT(split.triangles.size(), mesh.triangles.size());
}

}  // namespace
}  // namespace leaflight
