// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/cell_bounds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fields.h"
#include "trace/isosurface_ray.h"

namespace leaflight {
namespace {

enum class Kind { smooth, rough, whole, masked };

// A field whose sides are no multiples of a brick's side.
template <int D>
Field<D> field_of(Kind kind, double factor = 1) {
  Index<D> dims;
  for (int a = 0; a < D; ++a) dims[a] = 37 - 7 * a;
  Random random(5);
  std::vector<float> values;
  Index<D> none{};
  for_each_index<D>(none, dims, [&](const Index<D>& i) {
    double h = 0;
    for (int a = 0; a < D; ++a) h += std::sin(0.11 * i[a] + a) - 0.02 * a * i[a];
    if (kind != Kind::smooth) h = random.uniform();
    if (kind == Kind::whole) h = std::floor(200 * h) - 90;
    if (kind == Kind::masked && random.uniform() < 0.02) h = std::nan("");
    values.push_back(static_cast<float>(factor * h));
  });
  return test::field_from<D>(std::move(values), dims, test::unit_cube<D>(2));
}

template <int D>
void expect_bounds_hold(const Field<D>& field, double c) {
  const CellBounds<D>& bounds = field.cell_bounds();
  const auto limits = bounds.limits(c);
  for (std::size_t b = 0; b < bounds.cells.size(); ++b) {
    const Index<D> brick = index_of<D>(b, bounds.dims[0]);
    Index<D> none{}, end;
    end.fill(CellBounds<D>::row);
    int i = 0;
    for_each_index<D>(none, end, [&](const Index<D>& at) {
      Index<D> voxel;
      for (int a = 0; a < D; ++a) {
        voxel[a] = std::min(brick[a] * CellBounds<D>::side + at[a], field.dims[a] - 1);
      }
      const float h = field.value(voxel);
      const std::uint8_t steps = bounds.cells[b].steps[i++];
      if (std::isnan(h)) {
        ASSERT_EQ(steps, CellBounds<D>::masked);
        return;
      }
      ASSERT_LT(steps, CellBounds<D>::masked);
      if (h >= c) {
        ASSERT_GE(steps, limits.may_be_above) << h;
      } else {
        ASSERT_LT(steps, limits.may_be_below) << h;
      }
      if (bounds.is_exact) {
        ASSERT_EQ(static_cast<float>(bounds.min + steps), h);
      }
    });
  }
  // Each voxel lies between the planes of its bricks, and within the bounds of their parents.
  for (int level = 0; level < CellBounds<D>::levels; ++level) {
    const int shift = CellBounds<D>::log2_side * (level + 1);
    Index<D> none{};
    for_each_index<D>(none, field.dims, [&](const Index<D>& voxel) {
      const float h = field.value(voxel);
      Index<D> brick;
      int child = 0;
      for (int a = D - 1; a >= 0; --a) {
        const int cell = std::min(voxel[a], field.dims[a] - 2);
        brick[a] = cell >> shift;
        child = child * 4 + (cell >> (shift - CellBounds<D>::log2_side) & 3);
      }
      const std::size_t b = linear_number<D>(brick, bounds.dims[level]);
      if (level > 0 && !std::isnan(h)) {
        const auto& children = bounds.bricks[level - 1][b];
        if (h >= c) {
          ASSERT_GE(children.high[child], limits.may_be_above);
        } else {
          ASSERT_LT(children.low[child], limits.may_be_below);
        }
      }
      const auto& slab = bounds.slabs[level][b];
      if (std::isinf(slab.high)) return;
      double rest = h;
      for (int a = 0; a < D; ++a) rest -= static_cast<double>(slab.gradient[a]) * voxel[a];
      ASSERT_TRUE(rest > slab.low && rest < slab.high);
    });
  }
}

template <int D>
IsosurfaceRay<D> random_ray(Random& random, const Field<D>& field) {
  IsosurfaceRay<D> ray;
  for (int a = 0; a < D; ++a) {
    ray.position[a] = (1.4 * random.uniform() - 0.2) * field.dims[a];
    ray.direction[a] = random.uniform() * field.dims[a] - ray.position[a];
  }
  ray.isovalue = field.min + random.uniform() * (field.max - field.min);
  return ray;
}

template <int D>
void expect_all_bounds_hold() {
  for (const Kind kind : {Kind::smooth, Kind::rough, Kind::whole, Kind::masked}) {
    const Field<D> field = field_of<D>(kind);
    EXPECT_EQ(field.cell_bounds().is_exact, kind == Kind::whole);
    for (const double share : {1e-9, 0.1, 0.5, 0.77, 1.0}) {
      const double c = field.min + share * (static_cast<double>(field.max) - field.min);
      expect_bounds_hold<D>(field, c);
      expect_bounds_hold<D>(
          field, std::max(std::nextafter(field.min, field.max), static_cast<float>(std::floor(c))));
    }
  }
}

TEST(CellBounds, Hold) {
  expect_all_bounds_hold<2>();
  expect_all_bounds_hold<3>();
}

TEST(CellBounds, SmoothDataHavePlanesAndNoiseHasNone) {
  const auto planes = [](Kind kind) {
    const Field<3> field = field_of<3>(kind);
    const auto& slabs = field.cell_bounds().slabs[0];
    return static_cast<double>(std::count_if(slabs.begin(), slabs.end(),
                                             [](const auto& s) { return !std::isinf(s.high); })) /
           slabs.size();
  };
  EXPECT_GT(planes(Kind::smooth), 0.9);
  EXPECT_LT(planes(Kind::rough), 0.1);
}

// Fields of whole numbers below 256 are read from 8-bit bounds. Doubled values exceed 8 bits, but
// must give identical hits.
TEST(CellBounds, WholeNumbersGiveTheSameHits) {
  const Field<3> whole = field_of<3>(Kind::whole), doubled = field_of<3>(Kind::whole, 2);
  ASSERT_TRUE(whole.cell_bounds().is_exact && !doubled.cell_bounds().is_exact);
  Random random(7);
  int hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    IsosurfaceRay<3> ray = random_ray(random, whole);
    if (i % 2) ray.isovalue = std::ceil(ray.isovalue);
    const auto found = intersect(whole, ray);
    ray.isovalue *= 2;
    const auto same = intersect(doubled, ray);
    ASSERT_EQ(found.has_value(), same.has_value());
    if (!found) continue;
    ++hits;
    ASSERT_EQ(found->t, same->t);
    ASSERT_EQ(found->from_above, same->from_above);
  }
  EXPECT_GT(hits, 5'000);
}

template <int D>
void expect_occlusion_where_there_are_hits() {
  for (const Kind kind : {Kind::smooth, Kind::rough, Kind::whole, Kind::masked}) {
    const Field<D> field = field_of<D>(kind);
    Random random(9);
    int hits = 0;
    for (int i = 0; i < 5'000; ++i) {
      IsosurfaceRay<D> ray = random_ray(random, field);
      if (i % 3 == 0) ray.t_max = random.uniform();
      const bool is_hit = intersect(field, ray).has_value();
      hits += is_hit;
      ASSERT_EQ(occluded(field, ray), is_hit);
    }
    EXPECT_GT(hits, 500);
  }
}

TEST(CellBounds, OcclusionIsAHit) {
  expect_occlusion_where_there_are_hits<2>();
  expect_occlusion_where_there_are_hits<3>();
}

}  // namespace
}  // namespace leaflight
