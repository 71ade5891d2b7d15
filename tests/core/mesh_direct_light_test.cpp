// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/mesh_direct_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "base/low_discrepancy.h"
#include "exact.h"
#include "scenes.h"
#include "transport/light_sampler.h"

namespace leaflight {
namespace {

Progress ignored;

// Returns a floor below the unit cube, or a segment in 2D, lit on both sides.
template <int D>
Mesh<D> floor_beneath() {
  if constexpr (D == 3) {
    return test::wall("floor", {-0.5, -0.5, -0.2}, {2, 0, 0}, {0, 2, 0}, Rgb(0.8f, 0.5f, 0.3f));
  } else {
    return test::wall(Vec<2>(-0.5, -0.2), {2, 0}, Rgb(0.8f, 0.5f, 0.3f));
  }
}

template <int D>
Scene<D> over_floor(const Light<D>& light) {
  Scene<D> scene = test::scene_of(test::ball<D>(41), Rgb(0.7f), {0.6, 0.9});
  scene.meshes.push_back(floor_beneath<D>());
  scene.lights.push_back(light);
  return scene;
}

// Compares direct light at the vertices of a mesh, for some isovalues, with shadow rays to random
// points on the lights.
template <int D>
test::Agreement against_rays(const Scene<D>& scene, int mesh = 0) {
  const SceneTracer<D> tracer(scene);
  const std::vector<SubdividedMesh<D>> meshes = subdivide(scene);
  const MeshDirectLight<D> direct(tracer, meshes, ignored);
  const LightSampler<D> lights(tracer);
  const FineMesh<D>& fine = meshes[mesh].fine;
  const int rays = test::fewer(512);
  const std::size_t step = 1 + fine.vertices.size() / 300;
  double difference = 0, square = 0, found_sum = 0, true_sum = 0;
  for (const double c : {0.63, 0.74, 0.85}) {
    for (const bool back : {false, true}) {
      const auto found = direct.radiance(mesh, c, back);
      for (std::size_t v = 0; v < found.size(); v += step) {
        const FacetPoint& p = fine.places[v];
        const SurfacePoint<D> at = tracer.facet_point(p.mesh, p.facet, p.u, p.v, !back, c);
        Imath::V3d truth(0);
        std::uint64_t traced = 0;
        for (int i = 0; i < rays; ++i) {
          const double choice = sobol_point(i, 99)[0];
          truth += Imath::V3d(lights.direct_radiance(at, choice, sobol_point(i, v), traced)) / rays;
        }
        difference += (Imath::V3d(found[v]) - truth).length2();
        square += truth.length2();
        found_sum += found[v].x + found[v].y + found[v].z;
        true_sum += truth.x + truth.y + truth.z;
      }
    }
  }
  return {found_sum / true_sum, std::sqrt(difference / square)};
}

template <int D>
void expect_agreement(const char* name, const Scene<D>& scene, double most = 0.03) {
  const test::Agreement found = against_rays(scene);
  EXPECT_NEAR(found.mean_ratio, 1, test::sanitized ? 0.1 : 0.01) << name << " in " << D << "D";
  EXPECT_LT(found.relative_rms, test::sanitized ? 0.3 : most) << name << " in " << D << "D";
}

template <int D>
Vec<D> place(double across, double up) {
  Vec<D> p(across);
  p[D - 1] = up;
  return p;
}

template <int D>
void expect_shadows_of_all_lights() {
  AreaLight<D> lamp{"lamp", place<D>(0.2, 1.5), {}, Rgb(1, 2, 3)};
  if constexpr (D == 3) {
    lamp.edges = {Vec3(0, 0.6, 0), Vec3(0.6, 0, 0)};
  } else {
    lamp.corner.x = 0.8;
    lamp.edges = {Vec<2>(-0.6, 0)};
  }
  expect_agreement<D>("lamp", over_floor<D>(lamp));
  expect_agreement<D>("small sphere",
                      over_floor<D>(PointLight<D>{"bulb", place<D>(0.1, 1.4), 0.05, Rgb(1), {}}));
  expect_agreement<D>(
      "sun", over_floor<D>(SunLight<D>{"sun", place<D>(0.2, -1).normalized(), Rgb(1), 0.2}));
  PointLight<D> below{"spot", place<D>(0.4, -1), 0, Rgb(1), {}};
  below.cone = {place<D>(0, 1), 0.8, 0.2, false};
  expect_agreement<D>("spot from below", over_floor<D>(below));
}

TEST(MeshDirectLight, IsThatOfShadowRaysInThePlane) { expect_shadows_of_all_lights<2>(); }
TEST(MeshDirectLight, IsThatOfShadowRays) { expect_shadows_of_all_lights<3>(); }

TEST(MeshDirectLight, KnowsShadowsOfMeshesAndLightOfMeshes) {
  Scene<3> scene = over_floor<3>(SunLight<3>{"sun", Vec3(0.3, 0.1, -1).normalized(), Rgb(1), 0.1});
  scene.meshes.push_back(test::wall("shade", {-0.4, 0, 0.1}, {0, 0.7, 0}, {0.6, 0, 0}, Rgb(0.5f)));
  expect_agreement<3>("shade", scene, 0.06);
  scene.lights.clear();
  scene.meshes.push_back(test::wall("glow", {0.9, 0.9, 0.5}, {0, 0.3, 0}, {0.3, 0, 0}, Rgb(0.5f)));
  scene.meshes.back().emission = Rgb(2.0f);
  expect_agreement<3>("glow", scene, 0.06);
}

// Both of two volumes must cast shadows, each with its own isovalue of the common isovalue.
TEST(MeshDirectLight, KnowsShadowsOfAllVolumes) {
  Scene<3> scene = over_floor<3>(
      AreaLight<3>{"lamp", {0.2, 0.2, 1.8}, {Vec3(0, 0.3, 0), Vec3(0.3, 0, 0)}, Rgb(1)});
  Volume<3> other = scene.volumes[0];
  other.field = test::sampled<3>(
      41, [](const Vec3& x) { return 300 - 200 * (x - Vec3(0.8, 0.7, 0.4)).length(); });
  other.offset = 100;
  other.scale = 200;
  scene.volumes.push_back(other);
  expect_agreement<3>("two volumes", scene);
}

// Isosurfaces that end at the border let light in at one end and out at the other.
TEST(MeshDirectLight, LightPassesThroughOpenIsosurfaces) {
  const auto tube = test::sampled<3>(41, [](const Vec3& x) {
    // Isosurfaces are open at the floor and at the ceiling.
    return 1 - std::hypot(x.x - 0.5, x.y - 0.5);
  });
  Scene<3> scene = over_floor<3>(
      AreaLight<3>{"lamp", {0.4, 0.4, 1.5}, {Vec3(0, 0.2, 0), Vec3(0.2, 0, 0)}, Rgb(3.0f)});
  scene.volumes[0] = test::scene_of(tube, Rgb(0.7f), {0.6, 0.9}).volumes[0];
  EXPECT_TRUE(SceneTracer<3>(scene).has_openings());
  expect_agreement("tube", scene);
}

TEST(MeshDirectLight, ReachesBesideTheLeastIsovalue) {
  const Scene<3> scene = over_floor<3>(PointLight<3>{"bulb", {0.4, 0.5, 1.6}, 0, Rgb(1), {}});
  const MeshDirectLight<3> direct(SceneTracer<3>(scene), subdivide(scene), ignored);
  const double least = scene.isovalue_range.min;
  const auto found = direct.radiance(0, least, false),
             beside = direct.radiance(0, least + 1e-4, false);
  double most = 0, difference = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    most = std::max<double>(most, found[v].x);
    difference += std::abs(found[v].x - beside[v].x);
  }
  EXPECT_GT(most, 0.01);
  EXPECT_LT(difference, 0.01 * most * static_cast<double>(found.size()));
}

TEST(MeshDirectLight, TakesWhatHasNotMovedFromEarlierWays) {
  const PointLight<3> still{"still", {0.9, 0.2, 1.4}, 0, Rgb(1), {}};
  const auto lights = [&](double x) {
    return std::vector<Light<3>>{PointLight<3>{"moved", {x, 0.7, 1.5}, 0, Rgb(1), {}}, still};
  };
  Scene<3> scene = over_floor<3>(still);
  scene.lights = lights(0.1);
  const auto direct = [&](std::size_t share, const MeshDirectLight<3>* earlier) {
    return MeshDirectLight<3>(SceneTracer<3>(scene), subdivide(scene), ignored, share, earlier);
  };
  const MeshDirectLight<3> before = direct(1, nullptr);
  scene.lights = lights(0.3);
  std::swap(scene.lights[0], scene.lights[1]);
  const MeshDirectLight<3> alone = direct(1, nullptr), after = direct(1, &before);
  ASSERT_EQ(after.rays(0).rays.size(), 2 * after.rays(0).sets.size());
  for (std::size_t i = 0; i < after.rays(0).rays.size(); ++i) {
    EXPECT_EQ(after.rays(0).rays[i].greatest, alone.rays(0).rays[i].greatest);
    EXPECT_EQ(after.rays(0).rays[i].share, alone.rays(0).rays[i].share);
  }
  EXPECT_EQ(after.radiance(0, 0.7, false), alone.radiance(0, 0.7, false));
  // The moved point has traced only some shadow rays; the other point must keep all of them.
  const MeshDirectLight<3> some = direct(light_point_sets, &before);
  for (std::size_t v = 0; v < some.rays(0).sets.size(); ++v) {
    EXPECT_EQ(some.rays(0).rays[2 * v].greatest, alone.rays(0).rays[2 * v].greatest);
    EXPECT_EQ(some.rays(0).rays[2 * v + 1].share, alone.rays(0).rays[2 * v + 1].share);
  }
}

// A point light has one light point, and one vertex in seven traces a shadow ray to it. Points of a
// wide lamp must count as much as with all shadow rays.
template <int D>
void expect_few_ways_to_show_shadows() {
  const PointLight<D> bulb{"bulb", place<D>(0.3, 1.5), 0, Rgb(1.5f), {}};
  const SunLight<D> sharp{"sun", place<D>(0.2, -1).normalized(), Rgb(1), 0},
      wide{"sky", place<D>(-0.3, -1).normalized(), Rgb(1), 0.4};
  for (const std::vector<Light<D>>& lights :
       {std::vector<Light<D>>{bulb}, {sharp}, {wide}, {sharp, wide}}) {
    Scene<D> scene = over_floor<D>(bulb);
    scene.lights = lights;
    const SceneTracer<D> tracer(scene);
    const std::vector<SubdividedMesh<D>> meshes = subdivide(scene);
    const MeshDirectLight<D> all(tracer, meshes, ignored),
        few(tracer, meshes, ignored, light_point_sets);
    const auto exact = all.radiance(0, 0.7, false), found = few.radiance(0, 0.7, false),
               open = all.unshadowed(0, false);
    double sum = 0, exact_sum = 0, difference = 0, shadow = 0;
    for (std::size_t v = 0; v < found.size(); ++v) {
      sum += found[v].x;
      exact_sum += exact[v].x;
      difference += (found[v] - exact[v]).length2();
      shadow += (open[v] - exact[v]).length2();
    }
    EXPECT_NEAR(sum, exact_sum, 0.02 * exact_sum);
    EXPECT_GT(shadow, 0);
    EXPECT_LT(difference, 0.1 * shadow);
  }
}

TEST(MeshDirectLight, ShowsTheShadowsOfSharpLampsByFewWays) {
  expect_few_ways_to_show_shadows<2>();
  expect_few_ways_to_show_shadows<3>();
}

TEST(MeshDirectLight, LiesBetweenTheVerticesOfIndirectLight) {
  Scene<3> scene = test::cornell(test::ball<3>(9), {0.6, 0.9});
  for (const SubdividedMesh<3>& mesh : subdivide(scene)) {
    EXPECT_EQ(mesh.fine.facets.size(), 4 * mesh.coarse.facets.size());
    ASSERT_EQ(mesh.between.size(), mesh.fine.vertices.size());
    for (std::size_t v = 0; v < mesh.between.size(); ++v) {
      const auto [a, b] = mesh.between[v];
      const Vec<3, float> middle = (mesh.coarse.vertices[a] + mesh.coarse.vertices[b]) * 0.5f;
      EXPECT_LT((middle - mesh.fine.vertices[v]).length(), 1e-6f);
    }
  }
}

// Facets that meet at 5 degrees form one curved surface; those at 45 degrees do not.
TEST(SubdividedMesh, SharesVerticesAcrossACurve) {
  for (const bool curved : {true, false}) {
    const double angle = (curved ? 5 : 45) * pi / 180;
    const auto y = static_cast<float>(1 + std::cos(angle));
    const auto z = static_cast<float>(std::sin(angle));
    Mesh<3> strip;
    strip.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, y, z}, {1, y, z}};
    strip.facets = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
    Scene<3> scene = test::scene_of(test::ball<3>(9), Rgb(0.7f), {0.6, 0.9});
    scene.meshes.push_back(strip);
    const FineMesh<3> fine = subdivide(scene)[0].fine;
    std::vector<double> tilts;
    for (std::size_t v = 0; v < fine.vertices.size(); ++v) {
      if (fine.vertices[v] == Vec<3, float>(0, 1, 0)) {
        tilts.push_back(std::acos(std::min(1.0, fine.normals[v].z)));
      }
    }
    ASSERT_EQ(tilts.size(), curved ? 1u : 2u);
    // Two of the three facets at this vertex are the steeper ones.
    EXPECT_NEAR(tilts.back(), curved ? angle * 2 / 3 : angle, 0.01 * angle);
  }
}

}  // namespace
}  // namespace leaflight
