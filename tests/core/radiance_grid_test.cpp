// SPDX-License-Identifier: GPL-3.0-or-later
// Tests lookups of indirect light.
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
                                                       field.dims, true, ignored);
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
void expect_linear() {
  const Scene<D> scene = slope<D>({0, 1});
  const Field<D>& field = test::field_of(scene);
  const auto grid = grid_of(scene, [](const Vec<D>& p) { return 2 + p[0] * p[0]; });
  Vec<D> position(5.3);
  position[0] = 8.4;
  const double expected = 2 + 0.6 * 64 + 0.4 * 81;
  for (const bool back : {false, true}) {
    EXPECT_NEAR(radiance_at(grid, field, position, back)[0], expected, 1e-4);
    std::vector<Vec<D>> all(20, position);
    std::vector<Vec<3, float>> found(all.size());
    radiance_at(ShownGrid<D>(grid), field, all, back, found.data());
    for (const Vec<3, float>& one : found) {
      EXPECT_EQ(one, radiance_at(grid, field, position, back));
    }
  }
}

TEST(IndirectLightAtPoints, IsInterpolatedBetweenTexels) {
  expect_linear<2>();
  expect_linear<3>();
}

}  // namespace
}  // namespace leaflight
