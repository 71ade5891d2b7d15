// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes in passes of rays: several volumes, mirrors and glass.
#include "bake/driver/ray_bake.h"

#include <gtest/gtest.h>

#include <sstream>

#include "base/error.h"
#include "whole_passes.h"

namespace leaflight {
namespace {

using test::same_bits;
using test::stopped_after;

// Returns two balls in overlapping boxes. The upper one casts a shadow on the lower one.
Scene<3> two_balls(int voxels = 17) {
  Scene<3> scene = test::cornell(test::ball<3>(voxels), {0.6, 0.9});
  scene.volumes.push_back(scene.volumes[0]);
  scene.volumes[1].name = "other";
  scene.volumes[1].field.index_to_world.origin += Vec3(0.3, 0, 0.3);
  scene.volumes[1].field.world_to_index = inverse(scene.volumes[1].field.index_to_world);
  return scene;
}

// Returns two overlapping balls.
Scene<3> merged_balls() {
  Scene<3> scene = two_balls(33);
  Field<3>& field = scene.volumes[1].field;
  field.index_to_world.origin -= Vec3(0.2, 0, 0.2);
  field.world_to_index = inverse(field.index_to_world);
  return scene;
}

Scene<3> beside_a_mirror() {
  Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  scene.meshes[0].scattering = Scattering::mirror;
  return scene;
}

Scene<3> glass_scene() {
  Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  scene.volumes[0].scattering = Scattering::glass;
  return scene;
}

// Keeps only one wall, because lighting walls at all nodes takes most of the time.
Scene<3> with_one_wall(Scene<3> scene) {
  scene.meshes.resize(1);
  return scene;
}

BakeSettings<3> by_rays(double error = 3) {
  BakeSettings<3> settings = test::in_passes(error);
  settings.resolution = {17, 17, 17};
  return settings;
}

void expect_same(const Baked<3>& a, const Baked<3>& b) {
  ASSERT_EQ(a.grids.size(), b.grids.size());
  for (std::size_t v = 0; v < a.grids.size(); ++v) {
    EXPECT_TRUE(same_bits(a.grids[v], b.grids[v]));
  }
  ASSERT_EQ(a.walls.radiance.size(), b.walls.radiance.size());
  for (std::size_t m = 0; m < a.walls.radiance.size(); ++m) {
    EXPECT_TRUE(same_bits(a.walls.radiance[m][0], b.walls.radiance[m][0]));
  }
}

TEST(RayBake, IsTheSameForAnyNumberOfThreads) {
  for (const Scene<3>& scene : {two_balls(), beside_a_mirror()}) {
    BakeSettings<3> settings = by_rays(20);
    settings.both_sides = true;
    std::vector<Baked<3>> bakes;
    for (const int threads : {1, 3}) {
      settings.threads = threads;
      bakes.push_back(test::baked(scene, settings));
    }
    expect_same(bakes[0], bakes[1]);
    EXPECT_GT(bakes[0].statistics.blocks, 0);
    EXPECT_GT(bakes[0].statistics.error_percent, 0);
  }
}

TEST(RayBake, GoesOnFromACheckpointWithTheSameBits) {
  for (const Scene<3>& scene : {with_one_wall(two_balls()), with_one_wall(glass_scene())}) {
    BakeSettings<3> settings = by_rays(20);
    settings.walls = true;
    settings.resolution = {9, 9, 9};
    std::string state;
    Checkpoints leaves;
    leaves.seconds = 0;
    leaves.save = [&](const Checkpoints::Write& write) {
      std::ostringstream stream;
      write(stream);
      if (state.empty()) state = stream.str();
    };
    BakeHooks<3> hooks;
    hooks.checkpoints = &leaves;
    const Baked<3> whole = test::baked(scene, settings, hooks);
    ASSERT_FALSE(state.empty());
    std::istringstream stream(state);
    Checkpoints from;
    from.restore = [&](const Checkpoints::Read& read) { read(stream); };
    hooks.checkpoints = &from;
    const Baked<3> resumed = test::baked(scene, settings, hooks);
    expect_same(whole, resumed);
    EXPECT_EQ(whole.statistics.blocks, resumed.statistics.blocks);
    EXPECT_EQ(whole.statistics.passes, resumed.statistics.passes);
  }
}

TEST(RayBake, ContinuesSeveralVolumes) {
  const Scene<3> scene = two_balls();
  BakeSettings<3> settings = by_rays(1e-3);
  const Baked<3> first = stopped_after(1, scene, settings);
  EXPECT_TRUE(first.statistics.stopped);
  const Baked<3> continued = test::continued(first, scene, settings);
  EXPECT_EQ(continued.statistics.passes, 2);
  EXPECT_EQ(continued.statistics.blocks, 2 * first.statistics.blocks);
  EXPECT_LT(continued.statistics.noise_percent, first.statistics.noise_percent);
}

TEST(RayBake, ContinuesWallsAsOneBake) {
  const Scene<3> scene = with_one_wall(two_balls());
  BakeSettings<3> settings = by_rays(1e-3);
  settings.walls = true;
  const Baked<3> continued = test::continued(stopped_after(1, scene, settings), scene, settings);
  const Baked<3> whole = stopped_after(2, scene, settings);
  ASSERT_EQ(continued.statistics.blocks, whole.statistics.blocks);
  const auto& walls = whole.walls.radiance;
  EXPECT_TRUE(same_bits(continued.walls.radiance[0][0], walls[0][0]));
}

TEST(RayBake, PointsWithinAnotherVolumeAreCovered) {
  const Scene<3> scene = merged_balls();
  const SceneTracer<3> tracer(scene);
  const Field<3>& field = scene.volumes[0].field;
  const Field<3>& other = scene.volumes[1].field;
  int covered = 0, all = 0;
  for (const Vec3& x : test::isosurface_points(field, 0.7, 200)) {
    const bool inside = value_at(other, other.world_to_index.point(x)) >= 0.7;
    EXPECT_EQ(tracer.is_covered(0, tracer.frame().point(x), 0.7), inside);
    covered += inside;
    ++all;
  }
  EXPECT_GT(covered, all / 20);
  EXPECT_LT(covered, all / 2);
}

TEST(RayBake, ShadowsOfOtherVolumesAreThoseOfRays) {
  const Scene<3> scene = two_balls();
  const SceneTracer<3> tracer(scene);
  const SplitLight<3> split = split_light(tracer);
  Progress progress;
  int dark = 0, agree = 0, all = 0;
  for (const int volume : {0, 1}) {
    const Field<3>& field = scene.volumes[volume].field;
    const DirectLight<3> direct(tracer, volume, split.points, {field.dims, false}, progress);
    const double c = 0.7;
    for (const Vec3& x : test::isosurface_points(field, c, 10)) {
      const Vec3 index = field.world_to_index.point(x);
      const SurfacePoint<3> point = tracer.isosurface_point(volume, locate(field, index), c, false);
      const TexelWeights<3> near = linear_weights(direct.lattice(), index);
      const VisibilityCode code{direct.code_range(), false};
      for (std::size_t i = 0; i < direct.points(); ++i) {
        const LightSource<3>& source = direct.point(i).source;
        if ((source.position - point.position).dot(point.geometric_normal) <= 0) continue;
        const bool hidden = tracer.occluded(point, source.position, source.normal);
        dark += hidden;
        agree += hidden == (direct.greatest(i, near, false) >= code(c));
        ++all;
      }
    }
  }
  EXPECT_GT(dark, all / 50);
  EXPECT_GT(agree, 0.95 * all);
}

TEST(RayBake, AgreesWithThePathTracer) {
  if (test::sanitized) GTEST_SKIP() << "statistics are for other builds";
  const struct {
    const char* name;
    Scene<3> scene;
    double error;
  } cases[] = {{"two balls", two_balls(), 1.5},
               {"merged balls", merged_balls(), 0.7},
               {"beside a mirror", beside_a_mirror(), 1.5}};
  for (const auto& [name, scene, error] : cases) {
    const SceneTracer<3> tracer(scene);
    const Field<3>& field = scene.volumes[0].field;
    std::vector<Vec3> points;
    for (const Vec3& x : test::isosurface_points(field, 0.7, 10)) {
      if (!tracer.is_covered(0, tracer.frame().point(x), 0.7)) points.push_back(x);
    }
    const auto truth = test::traced(scene, points, 0.7, 1024, 5);
    BakeSettings<3> settings = by_rays(error);
    settings.resolution = field.dims;
    const Baked<3> baked = test::baked(scene, settings);
    const test::Agreement agreement = test::compare(points.size(), truth, [&](std::size_t i) {
      return test::lookup_world(scene, baked, points[i]);
    });
    EXPECT_NEAR(agreement.mean_ratio, 1, 0.03) << name;
    EXPECT_LT(agreement.relative_rms, 0.1) << name;
  }
}

}  // namespace
}  // namespace leaflight
