// SPDX-License-Identifier: GPL-3.0-or-later
#include "figures.h"
#include "trace/scene_tracer.h"

namespace leaflight {
namespace {

// Returns a scene of the unit cube far from the origin, where coordinates keep 36 of their 53 bits.
Scene<3> displaced(Field<3> field) {
  field.index_to_world.origin += Vec3(1e5, -1e5, 1e5);
  return test::scene_of(make_field<3>(field.values, field.dims, field.index_to_world, field.owner),
                        Rgb(1), {0, 1});
}

// Returns a random point, or a point of a face, an edge or a corner of the grid. Through cracks
// between cells, rays would leak at such points.
Vec3 target(Random& random, int voxels) {
  Vec3 p;
  const int on_grid = static_cast<int>(4 * random.uniform());
  for (int a = 0; a < 3; ++a) {
    p[a] = (voxels - 1) * random.uniform();
    if (a < on_grid) p[a] = std::round(p[a]);
  }
  return p;
}

// Expects rays that start above the isovalue to hit the closed isosurface from above, and none to
// leave it.
void expect_closed(const std::string& name, Field<3> field, double c, std::int64_t rays) {
  const Scene<3> scene = displaced(std::move(field));
  const SceneTracer<3> tracer(scene);
  const Field<3>& inside = test::field_of(scene);
  const int voxels = inside.dims[0];
  Random random(83);
  std::int64_t leaks = 0, wrong_sides = 0;
  for (std::int64_t i = 0; i < rays; ++i) {
    Vec3 from;
    do {
      for (int a = 0; a < 3; ++a) from[a] = (voxels - 1) * random.uniform();
    } while (value_at(inside, from) < c + 1e-6);
    const Affine<3>& index_to_frame = tracer.index_to_frame(0);
    const Vec3 origin = index_to_frame.point(from);
    const Vec3 direction = (index_to_frame.point(target(random, voxels)) - origin).normalized();
    const Hit<3> hit = tracer.intersect(origin, direction, c);
    leaks += hit.kind != HitKind::isosurface;
    wrong_sides += hit.kind == HitKind::isosurface && !hit.isosurface.from_above;
  }
  EXPECT_EQ(leaks, 0);
  EXPECT_EQ(wrong_sides, 0);
  test::figure(name + ": rays", rays);
  test::figure(name + ": leaks", leaks);
}

TEST(NumericsWatertight, BallOffCenter) {
  expect_closed("ball off center", test::ball<3>(24, {0.43, 0.56, 0.47}), 0.71,
                test::trials(1'000'000, 100'000'000));
}

TEST(NumericsWatertight, Noise) {
  expect_closed("noise", test::noise<3>(12, 5, -1.0), 0.5, test::trials(1'000'000, 100'000'000));
}

// Test 8-bit data at one of their values.
TEST(NumericsWatertight, IntegersAtAnIntegerIsovalue) {
  Random random(89);
  const Field<3> field = test::sampled<3>(12, [&](const Vec3& x) {
    const double h = std::floor(4 * random.uniform()) / 4;
    for (int a = 0; a < 3; ++a) {
      if (x[a] == 0 || x[a] == 1) return 0.0;
    }
    return h;
  });
  expect_closed("integers", field, 0.5, test::trials(1'000'000, 100'000'000));
}

}  // namespace
}  // namespace leaflight
