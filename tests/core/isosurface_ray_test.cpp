// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/isosurface_ray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fields.h"

namespace leaflight {
namespace {

using test::ball;
using test::noise;

template <int D>
double clamped_value(const Field<D>& field, const Vec<D>& index) {
  const CellPoint<D> p = locate(field, index);
  return interpolate(load_corners(field, p.cell), p.local);
}

template <int D>
Vec<D> random_unit(Random& random) {
  Vec<D> d;
  do {
    for (int a = 0; a < D; ++a) d[a] = 2 * random.uniform() - 1;
  } while (d.length() > 1 || d.length() < 0.1);
  return d.normalized();
}

template <int D>
IsosurfaceRay<D> ray_from(const Vec<D>& position, const Vec<D>& direction, double isovalue) {
  return {{}, position, direction, isovalue};
}

// Returns a ray that leaves its isosurface.
IsosurfaceRay<3> ray_leaving(const CellPoint<3>& origin, const Vec3& direction, double isovalue) {
  IsosurfaceRay<3> ray{origin, origin.index_position(), direction, isovalue};
  ray.starts_on_isosurface = true;
  return ray;
}

// Finds the first sign change by small steps, without bounds and polynomials.
template <int D>
double marched(const Field<D>& field, const IsosurfaceRay<D>& ray, double step) {
  bool known = false, above = false;
  for (double t = 0; t < 1000 && t <= ray.t_max; t += step) {
    const Vec<D> p = ray.position + ray.direction * t;
    if (!inside(field, p)) {
      if (known) return -1;
      continue;
    }
    const bool now = clamped_value(field, p) >= ray.isovalue;
    if (known && now != above) return t;
    known = true;
    above = now;
  }
  return -1;
}

template <int D>
void expect_agreement_with_marching(const Field<D>& field, double c, double step, int rays) {
  Random random(11);
  int hits = 0, disagreements = 0;
  for (int i = 0; i < rays; ++i) {
    IsosurfaceRay<D> ray;
    for (int a = 0; a < D; ++a) ray.position[a] = (random.uniform() * 2 - 0.5) * field.dims[a];
    ray.direction = random_unit<D>(random);
    ray.isovalue = c;
    const auto hit = intersect(field, ray);
    const double expected = marched(field, ray, step);
    if (hit) {
      ++hits;
      // Any hit must lie on the isosurface.
      EXPECT_NEAR(clamped_value(field, ray.position + ray.direction * hit->t), c, 1e-9);
    }
    // Small steps may miss a thin part, but never find a crossing that does not exist.
    const bool agrees = expected < 0 ? !hit || marched(field, ray, step / 64) >= 0
                                     : hit && hit->t <= expected + 1e-9 &&
                                           (hit->t > expected - step - 1e-9 ||
                                            marched(field, ray, step / 64) < expected - step / 2);
    disagreements += !agrees;
  }
  EXPECT_GT(hits, rays / 50);
  EXPECT_EQ(disagreements, 0);
}

TEST(IsosurfaceRay, AgreesWithMarchingOnNoise) {
  expect_agreement_with_marching<3>(noise<3>(9, 1, 0.0), 0.5, 1e-2, 1000);
  expect_agreement_with_marching<2>(noise<2>(17, 2, 0.0), 0.5, 1e-2, 1000);
}

TEST(IsosurfaceRay, AgreesWithMarchingOnSmoothField) {
  expect_agreement_with_marching<3>(ball<3>(33), 0.7, 1e-2, 500);
  expect_agreement_with_marching<2>(ball<2>(33), 0.7, 1e-2, 1000);
}

template <int D>
void expect_watertight(const Field<D>& field, double c, const Vec<D>& from, int rays) {
  Random random(3);
  const bool above = clamped_value(field, from) >= c;
  ASSERT_TRUE(above);
  for (int i = 0; i < rays; ++i) {
    const auto hit = intersect(field, ray_from<D>(from, random_unit<D>(random), c));
    ASSERT_TRUE(hit) << "ray " << i << " left a closed isosurface";
    ASSERT_TRUE(hit->from_above);
  }
}

TEST(IsosurfaceRay, ClosedIsosurfaceHoldsRays) {
  expect_watertight<3>(ball<3>(24), 0.61, {14.37, 9.71, 12.2}, 200'000);
  expect_watertight<2>(ball<2>(24), 0.61, {14.37, 9.71}, 200'000);
}

// Crossings must alternate between the sides. A ray from outside must cross a closed isosurface an
// even number of times. Restarts at each hit must neither repeat nor skip a crossing.
TEST(IsosurfaceRay, RestartingVisitsEachCrossingOnce) {
  const Field<3> field = noise<3>(12, 6, -1.0);
  Random random(23);
  int crossings = 0;
  for (int i = 0; i < 20'000; ++i) {
    IsosurfaceRay<3> ray;
    const Vec3 target(11 * random.uniform(), 11 * random.uniform(), 11 * random.uniform());
    ray.direction = test::random_direction(random);
    ray.position = target - ray.direction * 40;
    ray.isovalue = 0.5;
    bool above = false;
    double last = -1;
    for (;;) {
      const auto hit = intersect(field, ray);
      if (!hit) break;
      ++crossings;
      ASSERT_EQ(hit->from_above, above) << "ray " << i;
      const Vec3 position = hit->point.index_position();
      const double along = (position - target).dot(ray.direction);
      ASSERT_GT(along, last < 0 ? -100 : last - 1e-9);
      last = along;
      above = !above;
      ray.starts_on_isosurface = true;
      ray.starts_above = above;
      ray.origin = hit->point;
      ray.position = position;
    }
    ASSERT_FALSE(above) << "ray " << i << " ended inside a closed isosurface";
  }
  EXPECT_GT(crossings, 50'000);
}

TEST(IsosurfaceRay, ConvexIsosurfaceIsNeverHitAgainFromOutside) {
  const Field<3> field = ball<3>(40);
  Random random(29);
  int left = 0;
  for (int i = 0; i < 50'000; ++i) {
    IsosurfaceRay<3> ray;
    ray.direction = test::random_direction(random);
    ray.position = Vec3(19.5) - ray.direction * 60 + test::random_direction(random) * 10;
    ray.isovalue = 0.6;
    const auto hit = intersect(field, ray);
    if (!hit) continue;
    const CellCorners<3> corners = load_corners(field, hit->point.cell);
    const Vec3 outward = -geometric_gradient(corners, hit->point.local);
    const auto next = ray_leaving(hit->point, test::random_direction(random), 0.6);
    // Exclude grazing rays, which may hit facets.
    if (next.direction.dot(outward.normalized()) < 0.1) continue;
    ++left;
    ASSERT_FALSE(intersect(field, next)) << "ray " << i;
  }
  EXPECT_GT(left, 10'000);
}

TEST(IsosurfaceRay, IntegerDataAtIntegerIsovalue) {
  // The field is 1 with a slab of value 2. At isovalue 2, the isosurface lies on the slab's voxels.
  const Field<3> field =
      test::sampled<3>(9, [](const Vec3& x) { return x.z > 0.4 && x.z < 0.6 ? 2.0 : 1.0; });
  const auto hit = intersect(field, ray_from<3>({4.3, 4.6, -5}, {0, 0, 1}, 2));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 9, 1e-12);
  EXPECT_FALSE(hit->from_above);
  // From this surface, rays outwards hit nothing. Rays inwards hit the other side of the slab,
  // which is h == 2 on one layer of voxels.
  EXPECT_FALSE(intersect(field, ray_leaving(hit->point, {0, 0, -1}, 2)));
}

// The isosurface is a plane through voxels that have exactly the isovalue. Rays from points in
// cells, on their edges and at their corners must see the whole half space.
TEST(IsosurfaceRay, StartsOnEdgesAndCornersOfCells) {
  const Field<3> field = test::sampled<3>(17, [](const Vec3& x) { return x.z; });
  Random random(31);
  for (const Vec3& start : {Vec3(4.3, 7.8, 8), Vec3(4, 7.8, 8), Vec3(4, 8, 8), Vec3(5, 3, 8)}) {
    for (int i = 0; i < 2000; ++i) {
      auto ray = ray_leaving(locate(field, start), test::random_direction(random), 0.5);
      ray.starts_above = ray.direction.z > 0;
      const auto hit = intersect(field, ray);
      ASSERT_FALSE(hit) << start << ray.direction << " t " << hit->t << " cell "
                        << hit->point.cell[0] << " " << hit->point.cell[1] << " "
                        << hit->point.cell[2];
    }
  }
}

TEST(IsosurfaceRay, AxisParallelAndDegenerateDirections) {
  const Field<3> field = ball<3>(21);
  for (const double tiny : {0.0, 5e-324, 1e-310, 1e-30}) {
    // Both rays pass through voxels, along edges of cells.
    for (const auto& ray : {ray_from<3>({10, 10, -3}, {tiny, -tiny, 1}, 0.75),
                            ray_from<3>({10, 10, 23}, {tiny, tiny, -1}, 0.75)}) {
      const auto hit = intersect(field, ray);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->t, 3 + 5, 0.1);
    }
  }
}

TEST(IsosurfaceRay, MaskedCellsHaveNoIsosurface) {
  // h = x. The layer of cells with the isosurface is masked.
  std::vector<float> values(8 * 8 * 8);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int x = static_cast<int>(i % 8);
    values[i] = x == 4 ? std::nanf("") : static_cast<float>(x);
  }
  const auto field = test::field_from<3>(values, {8, 8, 8}, test::unit_cube<3>(8));
  auto ray = ray_from<3>({-1, 3.3, 3.3}, {1, 0, 0}, 4.2);
  EXPECT_FALSE(intersect(field, ray));
  ray.isovalue = 2.5;
  const auto hit = intersect(field, ray);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 3.5, 1e-12);
  ray.isovalue = 5.5;
  ASSERT_TRUE(intersect(field, ray));
}

TEST(IsosurfaceRay, EndsAtItsMaximum) {
  const Field<3> field = ball<3>(21);
  auto ray = ray_from<3>({10, 10, -3}, {0, 0, 1}, 0.75);
  ray.t_max = 7.5;
  EXPECT_FALSE(intersect(field, ray));
  ray.t_max = 8.5;
  EXPECT_TRUE(intersect(field, ray));
}

}  // namespace
}  // namespace leaflight
