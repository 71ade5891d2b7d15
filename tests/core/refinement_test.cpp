// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/fixed/refinement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/driver/bake.h"
#include "bake/texels/texel_samples.h"
#include "math/error.h"
#include "math/progress.h"
#include "scenes.h"
#include "thesis/thesis.h"
#include "transport/reference.h"

namespace leaflight {
namespace {

constexpr IsovalueWindow everything{-1, 2};

// h = x in the unit cube, whose 9^3 texels have the radiance f(index position).
template <class F>
RadianceGrid<3> painted(const Field<3>& field, F f) {
  RadianceGrid<3> grid;
  grid.lattice = make_lattice(field, {9, 9, 9}, everything.min, everything.max);
  for (const std::uint32_t texel : grid.lattice.active) {
    const Vec3 at = to_vector<3>(grid.lattice.texel(texel)) * grid.lattice.voxels_per_texel;
    grid.radiance.emplace_back(static_cast<float>(f(at)));
    grid.radiance_indirect.emplace_back(0.0f);
    grid.radiance_error.push_back(0);
  }
  return grid;
}

Field<3> ramp() {
  return test::sampled<3>(9, [](const Vec3& x) { return x.x; });
}

std::size_t count(const std::vector<bool>& cells) {
  return static_cast<std::size_t>(std::count(cells.begin(), cells.end(), true));
}

TEST(Refinement, ChoosesCellsWhereLightVaries) {
  const Field<3> field = ramp();
  const auto step = [](const Vec3& at) { return at.z > 4.5 ? 0.5 : 0.1; };
  const std::vector<bool> cells = cells_to_refine(field, everything, painted(field, step), 1.0);
  // One layer of 8^2 cells, fewer than a fifth of 8^3.
  EXPECT_EQ(count(cells), 64u);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(cells[i], (index_of<3>(i, {8, 8, 8})[2] == 4)) << i;
  }
}

TEST(Refinement, TakesTheShareWhereItVariesMost) {
  const Field<3> field = ramp();
  const auto curved = [](const Vec3& at) { return 1e-3 * at.z * at.z; };
  const std::vector<bool> cells = cells_to_refine(field, everything, painted(field, curved), 1.0);
  EXPECT_EQ(count(cells), static_cast<std::size_t>(refined_share * 512));
  // The slope grows with z.
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int z = index_of<3>(i, {8, 8, 8})[2];
    EXPECT_TRUE(z < 7 || cells[i]) << i;
    EXPECT_FALSE(z < 6 && cells[i]) << i;
  }
}

TEST(Refinement, LeavesNoiseAndWhiteAlone) {
  const Field<3> field = ramp();
  Random random(1);
  RadianceGrid<3> noise = painted(field, [&](const Vec3&) { return 0.5 + 0.1 * random.uniform(); });
  EXPECT_GT(count(cells_to_refine(field, everything, noise, 1.0)), 90u);
  noise.radiance_error.assign(noise.radiance.size(), 0.1f);
  EXPECT_EQ(count(cells_to_refine(field, everything, noise, 1.0)), 0u);
  const auto bright = [](const Vec3& at) { return 2 + at.z; };
  const RadianceGrid<3> white = painted(field, bright);
  EXPECT_EQ(count(cells_to_refine(field, everything, white, 1.0)), 0u);
  EXPECT_GT(count(cells_to_refine(field, everything, white, 0.1)), 90u);
}

TEST(Refinement, LeavesCellsWithoutLeavesOfTheWindowAlone) {
  const Field<3> field = ramp();
  const auto wavy = [](const Vec3& at) { return 0.5 + 0.4 * std::sin(3 * at.x + 5 * at.z); };
  const IsovalueWindow narrow{0.51, 0.6};
  const std::vector<bool> cells = cells_to_refine(field, narrow, painted(field, wavy), 1.0);
  EXPECT_GT(count(cells), 0u);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_TRUE(!cells[i] || (index_of<3>(i, {8, 8, 8})[0] == 4)) << i;
  }
}

// A small lamp above a torus, whose shadow falls on itself.
Scene<3> shadowed() {
  Scene<3> scene = test::cornell(test::torus(17), {0.75, 0.95});
  scene.lights[0] =
      AreaLight<3>{"lamp", {0.1, 0.3, 1.0}, {Vec3(0, 0.05, 0), Vec3(0.05, 0, 0)}, Rgb(200.0f)};
  return scene;
}

Baked<3> baked(const Scene<3>& scene, int refine, int texels = 17) {
  BakeSettings<3> settings;
  settings.resolution = {texels, texels, texels};
  settings.samples = 64;
  settings.photons = 200'000;
  settings.refine = refine;
  settings.exposure = 0.5;
  Progress progress;
  return bake(scene, settings, progress);
}

TEST(Refinement, IsContinuousAndServesWholeCells) {
  const Scene<3> scene = shadowed();
  const Baked<3> bake = baked(scene, 2);
  const RadianceGrid<3>& grid = bake.grids[0];
  ASSERT_EQ(grid.levels(), 3);
  EXPECT_EQ(grid.finer[0].lattice.resolution, (Index<3>{33, 33, 33}));
  Random random(3);
  int crossed = 0, fine = 0;
  for (int i = 0; i < 200'000; ++i) {
    // On a face between cells of the finest level.
    const int axis = i % 3;
    Vec3 at(16 * random.uniform(), 16 * random.uniform(), 16 * random.uniform());
    at[axis] = std::round(4 * at[axis]) / 4;
    // Leaves outside the window have no texels of their own to be continuous in.
    const CellPoint<3> point = locate(test::field_of(scene), at);
    const double h = interpolate(load_corners(test::field_of(scene), point.cell), point.local);
    if (!scene.window.contains(h)) continue;
    fine += grid.level_at(at) > 0;
    Vec3 before = at, after = at;
    before[axis] = std::max(0.0, at[axis] - 1e-9);
    after[axis] = std::min(16.0, at[axis] + 1e-9);
    const RadianceLevel<3>&a = grid.at(before), &b = grid.at(after);
    crossed += &a != &b;
    const auto left = lookup(a.lattice, a.radiance, before);
    const auto right = lookup(b.lattice, b.radiance, after);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(left[k], right[k], 1e-5) << at;
  }
  EXPECT_GT(crossed, 1000);
  EXPECT_GT(fine, 1000);
}

// RMS error of the displayed colours of the leaf 0.85, at points of a ring about the torus.
double error_of(const Scene<3>& scene, const Baked<3>& bake, const std::vector<Vec3>& points,
                const std::vector<ReferenceRadiance>& truth) {
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 position = test::field_of(scene).world_to_index.point(points[i]);
    const RadianceLevel<3>& from = bake.grids[0].at(position);
    const Vec3 difference =
        Vec3(lookup(from.lattice, from.radiance, position)) - Vec3(truth[i].radiance);
    squares += 0.25 * difference.length2() / 3;
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

TEST(Refinement, TakesAwayWhatCoarseTexelsErrBy) {
  const Scene<3> scene = shadowed();
  const Field<3>& field = test::field_of(scene);
  std::vector<Vec3> points;
  Random random(5);
  while (points.size() < 400) {
    const Vec3 at(16 * random.uniform(), 16 * random.uniform(), 16 * random.uniform());
    const CellPoint<3> point = locate(field, at);
    const double h = interpolate(load_corners(field, point.cell), point.local);
    if (std::abs(h - 0.85) > 0.03) continue;
    const Vec3 moved = moved_to_leaf(field, at, 0.85);
    const CellPoint<3> there = locate(field, moved);
    if (std::abs(interpolate(load_corners(field, there.cell), there.local) - 0.85) > 1e-6) continue;
    points.push_back(field.index_to_world.point(moved));
  }
  Progress progress;
  const auto truth =
      reference_radiance(scene, points, test::reference_settings(0.85, 1024, 7), progress);
  const double coarse = error_of(scene, baked(scene, 0), points, truth);
  const double once = error_of(scene, baked(scene, 1), points, truth);
  const double everywhere = error_of(scene, baked(scene, 0, 33), points, truth);
  RecordProperty("coarse", std::to_string(coarse));
  RecordProperty("once", std::to_string(once));
  RecordProperty("everywhere", std::to_string(everywhere));
  // Of the squared error that texels of half the width everywhere take away.
  EXPECT_GT(coarse, 2 * everywhere);
  EXPECT_GT(coarse * coarse - once * once, 0.75 * (coarse * coarse - everywhere * everywhere));
}

TEST(Refinement, RefusesWhatItCannotDo) {
  const Scene<3> scene = shadowed();
  BakeSettings<3> settings;
  Progress progress;
  settings.refine = 5;
  EXPECT_THROW(bake(scene, settings, progress), Error);
  settings.refine = 1;
  ThesisSettings strewn;
  strewn.scattered.emplace();
  settings.thesis = std::make_shared<const ThesisSettings>(strewn);
  EXPECT_THROW(bake(scene, settings, progress), Error);
}

}  // namespace
}  // namespace leaflight
