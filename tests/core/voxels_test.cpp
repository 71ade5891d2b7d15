// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/voxels.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "agreement.h"
#include "field/empty_space.h"
#include "field/shading_gradient.h"
#include "scenes.h"
#include "surface/marching_cubes.h"
#include "trace/isosurface_ray.h"

namespace leaflight {
namespace {

template <class Array>
bool same_bits(const Array& a, const Array& b) {
  if (a.empty() || b.empty()) return a.size() == b.size();
  return a.size() == b.size() &&
         std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()),
                     a.size() * sizeof(a[0])) == 0;
}

// Returns a noisy ball over the full range of an integer type, stored in this type and as floats.
template <class Value>
struct Pair {
  Field<3> integers, floats;

  explicit Pair(int n) {
    const Field<3> ball = test::ball<3>(n);
    const double low = std::numeric_limits<Value>::lowest();
    const double range = std::numeric_limits<Value>::max() - low;
    Random random(n);
    const auto values = std::make_shared<std::vector<Value>>();
    for (const float h : test::values_of(ball)) {
      const double u = (h - ball.min) / (ball.max - ball.min);
      const double noise = h == ball.max || h == ball.min ? 0 : 0.1 * (random.uniform() - 0.5);
      values->push_back(
          static_cast<Value>(std::lround(low + range * std::clamp(u + noise, 0.0, 1.0))));
    }
    integers = make_field<3>(values->data(), ball.dims, ball.index_to_world, values);
    floats = test::field_from<3>({values->begin(), values->end()}, ball.dims, ball.index_to_world);
  }
  double isovalue(double share) const {
    return floats.min + share * (double{floats.max} - floats.min);
  }
};

template <class Value>
class VoxelsOf : public testing::Test {};
using Integers = testing::Types<std::uint8_t, std::int16_t, std::uint16_t>;
TYPED_TEST_SUITE(VoxelsOf, Integers);

TYPED_TEST(VoxelsOf, AreReadAsIfTheyWereFloats) {
  const Pair<TypeParam> pair(21);
  EXPECT_TRUE(std::holds_alternative<const TypeParam*>(pair.integers.values));
  EXPECT_EQ(pair.integers.min, std::numeric_limits<TypeParam>::lowest());
  EXPECT_EQ(pair.integers.max, std::numeric_limits<TypeParam>::max());
  EXPECT_EQ(test::values_of(pair.integers), test::values_of(pair.floats));
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = 20 * random.uniform();
    const CellPoint<3> at = locate(pair.integers, p);
    ASSERT_EQ(load_corners(pair.integers, at.cell).h, load_corners(pair.floats, at.cell).h);
    ASSERT_EQ(shading_gradient(pair.integers, at), shading_gradient(pair.floats, at));
    const Vec3 direction = test::random_direction(random);
    const IsosurfaceRay<3> ray{{}, p, direction, pair.isovalue(random.uniform())};
    const auto hit = intersect(pair.integers, ray), same = intersect(pair.floats, ray);
    ASSERT_EQ(hit.has_value(), same.has_value());
    if (!hit) continue;
    ASSERT_EQ(hit->t, same->t);
  }
}

TYPED_TEST(VoxelsOf, BoundTheSameIsosurfaces) {
  const Pair<TypeParam> pair(37);
  const double low = pair.isovalue(0.6), high = pair.isovalue(0.8);
  for (std::size_t level = 0; level < pair.integers.pyramid->levels.size(); ++level) {
    const auto &integers = pair.integers.pyramid->levels[level].bricks,
               &floats = pair.floats.pyramid->levels[level].bricks;
    EXPECT_TRUE(same_bits(integers, floats));
  }
  EXPECT_EQ(make_lattice<3>(pair.integers, {30, 31, 32}, low, high).active,
            make_lattice<3>(pair.floats, {30, 31, 32}, low, high).active);
  const EmptySpace<3> integers(pair.integers, low), floats(pair.floats, low);
  std::size_t empty = 0;
  for_each_index<3>({}, pair.integers.dims, [&](const Index<3>& voxel) {
    empty += integers.holds(voxel);
    ASSERT_EQ(integers.holds(voxel), floats.holds(voxel));
  });
  EXPECT_GT(empty, 0u);
  const IsosurfaceMesh mesh = contour(pair.integers, low), same = contour(pair.floats, low);
  EXPECT_GT(mesh.triangles.size(), 0u);
  EXPECT_TRUE(same_bits(mesh.vertices, same.vertices));
  EXPECT_TRUE(same_bits(mesh.normals, same.normals));
  EXPECT_EQ(mesh.triangles, same.triangles);
}

// Tests bakes in passes, by lines, and bakes with fixed samples, by rays.
TYPED_TEST(VoxelsOf, BakeToTheSameBits) {
  const Pair<TypeParam> pair(test::sanitized ? 8 : 15);
  BakeSettings<3> passes;
  passes.error = 20;
  const auto fixed = test::fixed_settings<3>(EstimatorName::gather, 2, 20'000);
  for (const bool in_passes : {true, false}) {
    std::vector<Baked<3>> bakes;
    for (const Field<3>& field : {pair.integers, pair.floats}) {
      const Scene<3> scene = test::cornell(field, {pair.isovalue(0.6), pair.isovalue(0.9)});
      bakes.push_back(in_passes ? test::baked(scene, passes) : test::baked(scene, fixed));
    }
    const RadianceGrid<3>&integers = bakes[0].grids[0], &floats = bakes[1].grids[0];
    EXPECT_GT(integers.lattice.active.size(), test::sanitized ? 50u : 1000u);
    EXPECT_EQ(integers.lattice.active, floats.lattice.active);
    EXPECT_TRUE(same_bits(integers.radiance, floats.radiance));
    EXPECT_TRUE(same_bits(integers.radiance_indirect, floats.radiance_indirect));
    EXPECT_TRUE(same_bits(integers.radiance_error, floats.radiance_error));
  }
}

}  // namespace
}  // namespace leaflight
