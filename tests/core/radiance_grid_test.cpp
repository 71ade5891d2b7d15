// SPDX-License-Identifier: GPL-3.0-or-later
// Tests lookups of indirect light, which use texels in front of the isosurface.
#include "bake/output/radiance_grid.h"

#include <gtest/gtest.h>

#include "agreement.h"

namespace leaflight {
namespace {

Progress ignored;

constexpr int nodes = 17;

// Returns a field whose values rise along x from 0 to 1, so that fronts face -x.
template <int D>
Scene<D> slope(const IsovalueRange& isovalue_range) {
  auto field = test::sampled<D>(nodes, [](const Vec<D>& x) { return x[0]; });
  return test::scene_of(std::move(field), Rgb(1), isovalue_range);
}

// Returns a grid without direct light, with the given indirect light at each index position and
// side.
template <int D, class Light>
RadianceGrid<D> grid_of(const Scene<D>& scene, Light light) {
  RadianceGrid<D> grid;
  const Field<D>& field = test::field_of(scene);
  grid.lattice =
      make_lattice(field, field.dims, scene.isovalue_range.min, scene.isovalue_range.max);
  const SceneTracer<D> tracer(scene);
  grid.direct = std::make_shared<const DirectLight<D>>(tracer, 0, std::vector<LightPoint<D>>(),
                                                       MapSettings<D>{field.dims, true}, ignored);
  for (const std::uint32_t texel : grid.lattice.active) {
    const Vec<3, float> found(static_cast<float>(light(grid.lattice.center(texel))));
    for (auto* values : {&grid.radiance, &grid.radiance_back, &grid.radiance_indirect,
                         &grid.radiance_back_indirect}) {
      values->push_back(found);
    }
  }
  return grid;
}

template <int D>
void expect_front_alone() {
  const Scene<D> scene = slope<D>({0, 1});
  const Field<D>& field = test::field_of(scene);
  const auto linear = [](const Vec<D>& p) { return 2 + 0.1 * p[0] + 0.05 * p[D - 1]; };
  // Behind the isosurface of 8.4, texels have other light, like the other face of a thin shell.
  const auto other_behind =
      grid_of(scene, [&](const Vec<D>& p) { return p[0] > 8.5 ? 100.0 : linear(p); });
  const auto other_before =
      grid_of(scene, [&](const Vec<D>& p) { return p[0] < 8.5 ? 100.0 : linear(p); });
  Vec<D> position(5.3);
  position[0] = 8.4;
  EXPECT_NEAR(radiance_at(other_behind, field, position, false)[0], linear(position), 1e-5);
  EXPECT_GT(radiance_at(other_behind, field, position, true)[0], 10);
  std::vector<Vec<D>> all(20, position);
  std::vector<Vec<3, float>> found(all.size());
  radiance_at(ShownGrid<D>(other_behind), field, all, false, found.data());
  for (const Vec<3, float>& one : found) {
    EXPECT_EQ(one, radiance_at(other_behind, field, position, false));
  }
  // Backs look towards +x.
  position[0] = 8.6;
  EXPECT_NEAR(radiance_at(other_before, field, position, true)[0], linear(position), 1e-5);
  EXPECT_GT(radiance_at(other_before, field, position, false)[0], 10);
}

TEST(IndirectLightAtPoints, IsThatInFrontOfTheIsosurface) {
  expect_front_alone<2>();
  expect_front_alone<3>();
}

TEST(IndirectLightAtPoints, IsThatOfTexelsAroundWhereNothingWasBakedInFront) {
  // 1.5 texels in front of the isosurface of 8.4, the value is below the isovalue range.
  const Scene<3> scene = slope<3>({7.5 / (nodes - 1), 1});
  const auto grid = grid_of(scene, [](const Vec3& p) { return p.x < 8.5 ? 1.0 : 2.0; });
  const Vec3 position(8.4, 5.3, 5.3);
  EXPECT_NEAR(radiance_at(grid, test::field_of(scene), position, false)[0], 1.4, 1e-5);
}

TEST(IndirectLightAtPoints, IsThatOfTexelsAroundWhereTheFieldTurnsInFront) {
  // The field has a valley at 7, about 1.5 texels in front of 8.4.
  auto field = test::sampled<3>(nodes, [](const Vec3& x) {
    const double from_valley = x.x - 7.0 / (nodes - 1);
    return from_valley * from_valley;
  });
  const Scene<3> scene = test::scene_of(std::move(field), Rgb(1), {0, 1});
  const auto grid = grid_of(scene, [](const Vec3& p) { return p.x < 8.5 ? 1.0 : 2.0; });
  const Vec3 position(8.4, 5.3, 5.3);
  EXPECT_NEAR(radiance_at(grid, test::field_of(scene), position, false)[0], 1.4, 1e-5);
}

TEST(IndirectLightAtPoints, NeverChangesByMoreThanAFactorOfTwo) {
  const Scene<3> scene = slope<3>({0, 1});
  const auto rising = grid_of(scene, [](const Vec3& p) { return std::pow(10.0, p.x - 8); });
  const auto falling = grid_of(scene, [](const Vec3& p) { return std::pow(10.0, 8 - p.x); });
  const Vec3 position(8.5, 5, 5);
  // Half a texel in front, a texel's center has the light 1.
  EXPECT_NEAR(radiance_at(rising, test::field_of(scene), position, false)[0], 1.45, 1e-4);
  EXPECT_NEAR(radiance_at(falling, test::field_of(scene), position, false)[0], 0.5, 1e-4);
}

}  // namespace
}  // namespace leaflight
