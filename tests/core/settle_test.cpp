// SPDX-License-Identifier: GPL-3.0-or-later
// Light traced at the vertices of an isosurface at rest: against closed forms, against the path
// tracer where a bake is wrong, and its promises.
#include "leaflight/bake/settle.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <thread>

#include "agreement.h"
#include "cancelling.h"
#include "leaflight/math/error.h"
#include "scenes.h"

namespace leaflight {
namespace {

constexpr double pi = 3.14159265358979323846;

// The leaf c is the plane z = 1 - c, its outer side above.
Field<3> planes(int n) {
  return test::sampled<3>(n, [](const Vec3& x) { return 1 - x.z; });
}

// The leaf `thin` is a plate, where there are 33 voxels one of them thick.
constexpr double thin = 0.985;
Field<3> plate(int n) {
  return test::sampled<3>(n, [](const Vec3& x) { return 1 - std::abs(x.z - 0.5); });
}

// A grid that says the same indirect light everywhere.
RadianceGrid<3> constant_grid(const Scene<3>& scene, float indirect) {
  RadianceGrid<3> grid;
  const Field<3>& field = test::field_of(scene);
  grid.lattice = make_lattice<3>(field, field.dims, scene.window.min, scene.window.max);
  grid.radiance_indirect.assign(grid.lattice.active.size(), Vec<3, float>(indirect));
  return grid;
}

SettleSettings at(double c, bool above = false) {
  SettleSettings settings;
  settings.c = c;
  settings.above = above;
  return settings;
}

struct Result {
  IsosurfaceMesh mesh;
  Settle::Settled settled;
};

Result settle(const Scene<3>& scene, float baked, const SettleSettings& settings) {
  const RadianceGrid<3> grid = constant_grid(scene, baked);
  const IsosurfaceMesh mesh = contour(test::field_of(scene), settings.c);
  Settle work(scene, grid, mesh, settings);
  Progress progress;
  while (work.rounds_done() < work.rounds()) work.refine(progress);
  EXPECT_GT(work.rays(), 0u);
  return {mesh, work.settled()};
}

TEST(Settle, APlaneBelowARectangleOfLight) {
  Scene<3> scene = test::scene_of(planes(9), Rgb(0.5f), {0.2, 0.9});
  scene.lights.push_back(
      AreaLight<3>{"lamp", {0, 0, 2}, {Vec3(0, 1, 0), Vec3(1, 0, 0)}, Rgb(4, 2, 1)});
  const auto [mesh, settled] = settle(scene, 0, at(0.5));
  ASSERT_EQ(settled.radiance.size(), mesh.vertices.size());
  // The view factor of a rectangle a x b from below its corner, at distance 1 (Hamilton and Morgan
  // 1952), for the four about a point.
  const auto corner = [](double a, double b) {
    const double p = std::hypot(1, a), q = std::hypot(1, b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * pi);
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double x = mesh.vertices[v].x, y = mesh.vertices[v].y, d = 1.5;
    const double factor = corner(x / d, y / d) + corner((1 - x) / d, y / d) +
                          corner(x / d, (1 - y) / d) + corner((1 - x) / d, (1 - y) / d);
    EXPECT_NEAR(settled.radiance[v].x, 0.5 * 4 * factor, 0.03 * 0.5 * 4 * factor);
    EXPECT_NEAR(settled.radiance[v].z, settled.radiance[v].x / 4, 1e-6);
    EXPECT_EQ(settled.error[v], 0);  // all its rays agree, and nothing reflects
  }
}

TEST(Settle, ABallInTheSun) {
  Scene<3> scene = test::scene_of(test::ball<3>(33), Rgb(0.6f), {0.5, 0.9});
  scene.lights.push_back(SunLight<3>{"sun", {0, 0, -1}, Rgb(2.0f)});
  const auto [mesh, settled] = settle(scene, 0, at(0.65));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 normal = (Vec3(mesh.vertices[v]) - Vec3(0.5)).normalized();
    const double expected = 0.6 * 2 / pi * std::max(0.0, normal.z);
    EXPECT_NEAR(settled.radiance[v].x, expected, 0.03 * 0.6 * 2 / pi) << v;
  }
}

TEST(Settle, TheFacesOfAThinPlateKeepApart) {
  Scene<3> scene = test::scene_of(plate(33), Rgb(0.7f), {0.97, 0.99});
  scene.lights.push_back(SunLight<3>{"sun", {0, 0, -1}, Rgb(3.0f)});
  // A floor brings light to the lower face; the upper one sees nothing that reflects. The bake has
  // mixed them up.
  scene.meshes.push_back(test::wall("floor", {-3, -3, 0}, Vec3(7, 0, 0), Vec3(0, 7, 0), Rgb(0.5f)));
  // One settling has so few paths that the mean of the lower face is off by some percent.
  constexpr int seeds = 8;
  double sum[2] = {0, 0}, true_sum[2] = {0, 0};
  for (int seed = 0; seed < seeds; ++seed) {
    SettleSettings settings = at(thin);
    settings.seed = seed;
    const auto [mesh, settled] = settle(scene, 0.4f, settings);
    const std::vector<Vec3> points(mesh.vertices.begin(), mesh.vertices.end());
    Progress progress;
    const auto truth = reference_radiance<3>(
        scene, points, test::reference_settings(thin, test::fewer(64), 3 + seed), progress);
    for (std::size_t v = 0; v < points.size(); ++v) {
      const int upper = points[v].z > 0.5;
      sum[upper] += settled.radiance[v].y;
      true_sum[upper] += truth[v].radiance.y;
      if (upper) {
        EXPECT_NEAR(settled.radiance[v].y, 0.7 * 3 / pi, 0.01);
      }
    }
  }
  if (test::sanitized) return;
  EXPECT_NEAR(sum[0] / true_sum[0], 1, 0.03);
  EXPECT_LT(sum[0], 0.6 * sum[1]);
}

TEST(Settle, PathsPutAWrongBakeRight) {
  const Scene<3> scene = test::cornell(test::ball<3>(33), {0.5, 0.9});
  for (const bool above : {false, true}) {
    const auto [mesh, settled] = settle(scene, above ? 0.0f : 0.3f, at(0.65, above));
    std::vector<Vec3> points;
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 7) points.emplace_back(mesh.vertices[v]);
    ReferenceSettings settings = test::reference_settings(0.65, test::fewer(512), 3);
    settings.above = above;
    Progress progress;
    const auto truth = reference_radiance<3>(scene, points, settings, progress);
    if (above) {  // no light enters a ball
      for (const auto& radiance : settled.radiance) EXPECT_EQ(radiance.length(), 0);
      continue;
    }
    const test::Agreement agreement =
        test::compare(points.size(), truth, [&](std::size_t i) { return settled.radiance[7 * i]; });
    if (test::sanitized) continue;
    EXPECT_NEAR(agreement.mean_ratio, 1, 0.03);
    EXPECT_LT(agreement.relative_rms, 0.15);
    // The errors that it reports are those that it has, and cover most of them.
    int covered = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double own = average(Rgb(settled.radiance[7 * i]));
      const double error = std::hypot(settled.error[7 * i], average(truth[i].standard_error));
      covered += std::abs(own - average(truth[i].radiance)) < 3 * error;
    }
    EXPECT_GT(covered, 0.8 * static_cast<double>(points.size()));
  }
}

TEST(Settle, IsTheSameForAnyNumberOfThreadsAndAfterCancelling) {
  const Scene<3> scene = test::cornell(test::torus(25), {0.7, 0.95});
  const RadianceGrid<3> grid = constant_grid(scene, 0.1f);
  const IsosurfaceMesh mesh = contour(test::field_of(scene), 0.85);
  std::vector<Settle::Settled> found;
  for (const int threads : {1, 2}) {
    Settle work(scene, grid, mesh, at(0.85));
    tbb::task_arena(threads).execute([&] {
      while (work.rounds_done() < work.rounds()) {
        Progress cancelled, progress;
        if (threads == 2) {
          std::thread canceller([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            cancelled.cancel();
          });
          try {
            work.refine(cancelled);
          } catch (const Cancelled&) {
          }
          canceller.join();
        }
        work.refine(progress);
      }
    });
    found.push_back(work.settled());
  }
  EXPECT_EQ(found[0].radiance, found[1].radiance);
  EXPECT_EQ(found[0].error, found[1].error);
}

// Settles a mesh again and again until it is cancelled; returns the seconds that cancelling took.
double seconds_to_cancel_settling(Settle& work) {
  return test::seconds_to_cancel([&](Progress& progress) {
    while (true) {
      if (work.rounds_done() == work.rounds())
        progress.check();
      else
        work.refine(progress);
    }
  });
}

TEST(Settle, IsCancelled) {
  const Scene<3> scene = test::cornell(test::ball<3>(33), {0.3, 0.9});
  const RadianceGrid<3> grid = constant_grid(scene, 0.1f);
  Settle work(scene, grid, contour(test::field_of(scene), 0.55), at(0.55));
  seconds_to_cancel_settling(work);
  // The result so far can be shown.
  EXPECT_EQ(work.settled().error.size(), work.settled().radiance.size());
}

TEST(Settle, IsCancelledWithinHalfASecond) {
  const Scene<3> scene = test::cornell(test::ball<3>(129), {0.3, 0.9});
  const RadianceGrid<3> grid = constant_grid(scene, 0.1f);
  Settle work(scene, grid, contour(test::field_of(scene), 0.55), at(0.55));
  EXPECT_LT(seconds_to_cancel_settling(work), 0.5);
}

TEST(Settle, BesideGlassTheBakeTellsTheIndirectLight) {
  Scene<3> scene = test::scene_of(planes(9), Rgb(0.5f), {0.2, 0.9});
  scene.lights.push_back(SunLight<3>{"sun", {0, 0, -1}, Rgb(2.0f)});
  scene.meshes.push_back(test::wall("pane", {2, 0, 0}, {0, 1, 0}, {0, 0, 1}, Rgb(1)));
  scene.meshes[0].scattering = Scattering::glass;
  const auto [mesh, settled] = settle(scene, 0.25f, at(0.5));
  for (const auto& radiance : settled.radiance) {
    EXPECT_NEAR(radiance.x, 0.25 + 0.5 * 2 / pi, 1e-5);
  }
  const RadianceGrid<3> grid = constant_grid(scene, 0.25f);
  EXPECT_THROW(Settle(scene, grid, mesh, at(0.5, true)), Error);
  scene.volumes[0].scattering = Scattering::mirror;
  EXPECT_THROW(Settle(scene, grid, mesh, at(0.5)), Error);
}

TEST(MeshSmoother, PassesNothingRoundACrease) {
  // Two triangles share an edge; one more stands across it, whose normals are at right angles.
  const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {2, 1, 3}, {1, 2, 4}};
  const Vec<3, float> up(0, 0, 1), side(1, 0, 0);
  const VertexFans fans(5, triangles);
  EXPECT_EQ(fans.size(1), 3u);
  EXPECT_EQ(fans.others(3, 0), (std::array<std::int32_t, 2>{2, 1}));
  const MeshSmoother smoother(fans, {up, up, up, up, side});
  std::vector<std::array<float, 2>> values{{1, 5}, {1, 5}, {0, 5}, {0, 5}, {9, 5}};
  smoother.smooth(values, 20);
  EXPECT_EQ(values[4][0], 9);
  for (int v = 0; v < 4; ++v) {
    EXPECT_GT(values[v][0], 0.2f);
    EXPECT_LT(values[v][0], 0.8f);
    EXPECT_NEAR(values[v][1], 5, 1e-5);
  }
}

}  // namespace
}  // namespace leaflight
