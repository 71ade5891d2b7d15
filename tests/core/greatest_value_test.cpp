// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/greatest_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fields.h"
#include "trace/isosurface_ray.h"

namespace leaflight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <int D>
struct Segment {
  Vec<D> from, direction;
  double t_max;
};

// Returns a segment that starts in or around a field; some are parallel to an axis or end soon.
template <int D>
Segment<D> random_segment(const Field<D>& field, Random& random) {
  Segment<D> segment;
  for (int a = 0; a < D; ++a) {
    segment.from[a] = (2 * random.uniform() - 0.5) * field.dims[a];
    segment.direction[a] = random.uniform() < 0.1 ? 0 : random.uniform() - 0.5;
  }
  // Aim at a random point inside the field.
  if (random.uniform() < 0.7) {
    for (int a = 0; a < D; ++a) {
      segment.direction[a] =
          (random.uniform() * (field.dims[a] - 1) - segment.from[a]) / field.dims[a];
    }
  }
  if (segment.direction.length() < 0.1) segment.direction[0] = 1;
  segment.t_max = random.uniform() < 0.5 ? infinity : 2.0 * field.dims[0] * random.uniform();
  return segment;
}

// Returns the greatest of many samples along a segment.
template <int D>
double marched(const Field<D>& field, const Segment<D>& segment, double least) {
  const double end = std::min(segment.t_max, 40.0 * field.dims[0]), steps = 100000;
  for (int i = 0; i <= steps; ++i) {
    const Vec<D> p = segment.from + segment.direction * (end * i / steps);
    if (!inside(field, p)) continue;
    const CellPoint<D> at = locate(field, p);
    least = std::max(least, interpolate(load_corners(field, at.cell), at.local));
  }
  return least;
}

template <int D>
void expect_samples_beneath(const Field<D>& field, int ways) {
  std::vector<float> values = test::values_of(field);
  for (float& value : values) value = -value;
  const Field<D> negative =
      test::field_from<D>(std::move(values), field.dims, field.index_to_world);
  Random random(5);
  double worst = 0;
  int greater = 0;
  for (int i = 0; i < ways; ++i) {
    const Segment<D> segment = random_segment<D>(field, random);
    const double least = field.min + 0.2 * (field.max - field.min);
    const double found =
        greatest_value(field, segment.from, segment.direction, segment.t_max, least);
    const double sampled = marched(field, segment, least);
    EXPECT_NEAR(least_value(negative, segment.from, segment.direction, segment.t_max, -least),
                -found, 1e-6);
    EXPECT_GE(found, sampled - 1e-9) << i;
    worst = std::max(worst, found - sampled);
    greater += found > least;
  }
  EXPECT_LT(worst, 2e-3 * (field.max - field.min));
  EXPECT_GT(greater, ways / 3);
}

TEST(GreatestValue, IsThatOfFineSamples) {
  expect_samples_beneath(test::ball<2>(70), 100);
  expect_samples_beneath(test::ball<3>(70), 100);
  expect_samples_beneath(test::noise<3>(7, 3, 0), 100);
  expect_samples_beneath(test::noise<3>(20, 4, 0), 100);
}

// A ray from outside hits exactly the isosurfaces up to the greatest value along it.
TEST(GreatestValue, TellsWhichIsosurfacesBlockTheWay) {
  const Field<3> field = test::sampled<3>(40, [](const Vec3& x) {
    const double edge = std::min({x.x, x.y, x.z, 1 - x.x, 1 - x.y, 1 - x.z});
    return std::min(1.0, 20 * edge) * (2 + std::sin(17 * x.x) * std::cos(13 * x.y + 11 * x.z));
  });
  Random random(6);
  int greater = 0;
  for (int i = 0; i < 2000; ++i) {
    Segment<3> segment = random_segment<3>(field, random);
    if (inside(field, segment.from)) continue;
    const double least = 0.05;
    const double found = greatest_value(field, segment.from, segment.direction, infinity, least);
    greater += found > least;
    for (const double c : {found - 1e-6, found + 1e-6}) {
      const IsosurfaceRay<3> ray{{}, segment.from, segment.direction, c};
      if (c > least) {
        EXPECT_EQ(occluded(field, ray), c < found) << i;
      }
    }
  }
  EXPECT_GT(greater, 1000);
}

TEST(GreatestValue, LeavesOutCellsWithoutData) {
  std::vector<float> values(10 * 10 * 10, 1.0f);
  const auto at = [&](int x) -> float& { return values[x + 10 * (5 + 10 * 5)]; };
  at(2) = 3.0f;
  at(6) = 9.0f;
  at(7) = std::numeric_limits<float>::quiet_NaN();
  const Field<3> field =
      test::field_from<3>(std::move(values), {10, 10, 10}, test::unit_cube<3>(10));
  const Vec3 from(-1, 5, 5), along(1, 0, 0);
  EXPECT_EQ(greatest_value(field, from, along, infinity, 0), 9);  // reached in the previous cell
  EXPECT_EQ(greatest_value(field, from, along, 5, 0), 3);
  EXPECT_EQ(greatest_value(field, Vec3(6.5, 5, 5), along, 1.4, 0), 0);
  EXPECT_EQ(greatest_value(field, Vec3(5, 5, -3), Vec3(0, 0, 1), 1, 0.5), 0.5);
}

}  // namespace
}  // namespace leaflight
