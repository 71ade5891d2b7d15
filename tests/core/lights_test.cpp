// SPDX-License-Identifier: GPL-3.0-or-later
// Tests each lamp against a closed form, and its photons against its shadow rays.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "base/sampling.h"
#include "scenes.h"
#include "statistics.h"
#include "transport/photon_tracer.h"

namespace leaflight {
namespace {

// Returns a scene with h = z: isosurfaces are planes whose outside faces -z, towards lights below.
Scene<3> plane(const Rgb& albedo) {
  return test::scene_of(test::sampled<3>(17, [](const Vec3& x) { return x.z; }), albedo,
                        {0.2, 0.8});
}

// The path-traced radiance over albedo / pi at a point of the isosurface 0.5, and its standard
// error.
struct Irradiance {
  double mean, error;
};
Irradiance irradiance_at(const Scene<3>& scene, const Vec3& point) {
  const auto r = test::traced(scene, std::vector<Vec3>{point}, 0.5, 65536, 1)[0];
  return {r.radiance.y * pi, r.standard_error.y * pi};
}

void expect_irradiance(const Scene<3>& scene, const Vec3& point, double expected) {
  const Irradiance e = irradiance_at(scene, point);
  EXPECT_NEAR(e.mean, expected, test::z_limit() * e.error + 2e-4 * expected);
}

const Vec3 place(0.4, 0.6, 0.5);

TEST(Lights, PointHasTheInverseSquareLaw) {
  Scene<3> scene = plane(Rgb(1));
  const Vec3 lamp(0.7, 0.5, -0.4);
  const double d = (lamp - place).length(), cosine = 0.9 / d;
  for (const double radius : {0.0, 0.3}) {
    // A sphere that is entirely above the horizon lights like a point at its center.
    scene.lights = {PointLight<3>{"bulb", lamp, radius, Rgb(1, 2, 3), {}}};
    expect_irradiance(scene, place, 2 * cosine / (d * d));
  }
}

TEST(Lights, SpotIsBlenders) {
  Scene<3> scene = plane(Rgb(1));
  const double half = 0.5, blend = 0.4;
  for (const double off_axis : {0.0, 0.3, 0.45, 0.55}) {
    const double height = 0.9;
    const Vec3 lamp(place.x - height * std::tan(off_axis), place.y, place.z - height);
    for (const bool fades : {false, true}) {
      scene.lights = {PointLight<3>{"spot", lamp, 0, Rgb(5),
                                    PointLight<3>::Cone{{0, 0, 1}, std::cos(half), blend, fades}}};
      const double cosine = std::cos(off_axis), d = height / cosine;
      const double t =
          std::clamp((cosine - std::cos(half)) / ((1 - std::cos(half)) * blend), 0., 1.);
      const double expected = 5 * cosine / (d * d) * t * t * (3 - 2 * t) * (fades ? cosine : 1);
      expect_irradiance(scene, place, expected);
    }
  }
}

TEST(Lights, SunHasItsIrradiance) {
  Scene<3> scene = plane(Rgb(1));
  const Vec3 direction = Vec3(0.3, -0.4, 1).normalized();
  for (const double angle : {0.0, 0.2, 1.0}) {
    scene.lights = {SunLight<3>{"sun", direction, Rgb(3), angle}};
    expect_irradiance(scene, place, 3 * direction.z);
  }
}

TEST(Lights, EllipseIsADisc) {
  // On the axis of a disk of radius r at distance d: pi L r^2 / (d^2 + r^2).
  Scene<3> scene = plane(Rgb(1));
  const double r = 0.3, d = 0.7;
  scene.lights = {AreaLight<3>{
      "disc", place + Vec3(-r, -r, -d), {Vec3(2 * r, 0, 0), Vec3(0, 2 * r, 0)}, Rgb(2), true}};
  expect_irradiance(scene, place, pi * 2 * r * r / (d * d + r * r));
}

TEST(Lights, EmissiveMeshIsItsArea) {
  // Compare a rectangle as a lamp with a black mesh of the same emission.
  Scene<3> lamp = plane(Rgb(1)), mesh = plane(Rgb(1));
  const Vec3 corner(0.1, 0.3, -0.4), u(0.5, 0, 0), v(0, 0.3, 0);
  lamp.lights = {AreaLight<3>{"lamp", corner, {u, v}, Rgb(4)}};
  mesh.meshes = {test::wall("glow", corner, u, v, Rgb(0))};
  mesh.meshes[0].emission = Rgb(4);
  const Irradiance a = irradiance_at(lamp, place), b = irradiance_at(mesh, place);
  EXPECT_NEAR(a.mean, b.mean, test::z_limit() * std::hypot(a.error, b.error));
  EXPECT_GT(a.mean, 10 * a.error);
}

// The image has the radiance max(0, cos)^4 about an axis. Directions with w.z < 0 reach the
// isosurface.
TEST(Lights, EnvironmentImageIntegratesToItsIrradiance) {
  auto image = std::make_shared<Texture>();
  image->width = 256;
  image->height = 128;
  const Vec3 axis = Vec3(0.5, 0.2, -0.8).normalized();
  const auto bright = [&](const Vec3& w) { return std::pow(std::max(0.0, w.dot(axis)), 4); };
  for (int j = 0; j < image->height; ++j) {
    for (int i = 0; i < image->width; ++i) {
      const double azimuth = (0.5 - (i + 0.5) / image->width) * 2 * pi;
      const double height = ((j + 0.5) / image->height - 0.5) * pi;
      image->pixels.emplace_back(
          static_cast<float>(bright({std::cos(height) * std::cos(azimuth),
                                     std::cos(height) * std::sin(azimuth), std::sin(height)})));
    }
  }
  Scene<3> scene = plane(Rgb(1));
  scene.environment = Environment<3>{"sky", Rgb(2), image, {}};
  scene.environment->world_to_image = test::unit_cube<3>(2);
  double expected = 0, turned = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Vec3 w = sample_cosine_hemisphere<3>({0, 0, -1}, {(i + 0.5) / n, (j + 0.5) / n});
      expected += 2 * pi * bright(w) / (n * n);
      turned += 2 * pi * bright(Vec3(-w.y, w.x, w.z)) / (n * n);
    }
  }
  const Irradiance found = irradiance_at(scene, place);
  EXPECT_NEAR(found.mean, expected, test::z_limit() * found.error + 2e-3 * expected);
  // Rotate the image by 90 degrees about z; the light must come from the rotated direction.
  scene.environment->world_to_image.column = {Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1)};
  expect_irradiance(scene, place, turned);
}

TEST(Lights, ConstantEnvironmentIsAFurnace) {
  Scene<3> scene =
      test::scene_of(test::ball<3>(33), Rgb(0.5f, 0.7f, 0.9f), IsovalueRange{0.55, 0.9});
  scene.environment = Environment<3>{"sky", Rgb(2), nullptr, {}};
  const Baked<3> baked = test::baked(scene, FixedSettings<3>());
  // A convex body sees only the environment, so its radiance is albedo times 2.
  const auto radiance = test::lookup_world<3>(scene, baked, Vec3(0.5, 0.5, 0.78));
  EXPECT_NEAR(radiance.x, 1.0, 1e-3);
  EXPECT_NEAR(radiance.z, 1.8, 1e-3);
}

// Expects photons to deliver the same irradiance on an isosurface as shadow rays.
template <int D>
void expect_photons_agree(const Scene<D>& scene) {
  const SceneTracer<D> tracer(scene);
  const LightSampler<D> lights(tracer);
  constexpr std::uint64_t count = test::fewer(500'000);
  double landed = 0, landed2 = 0;
  trace_photons(
      tracer, lights, PhotonPaths::all, 1, 0, count, count, [&](const PhotonHit<D>& photon) {
        if (photon.arrival == Arrival::direct && photon.point.kind() == HitKind::isosurface &&
            !photon.point.isosurface().back) {
          const double flux = average(photon.flux_height) * scene.isovalue_range.height();
          landed += flux;
          landed2 += flux * flux;
        }
      });
  // Integrate irradiance |grad c| over the volume.
  Random random(3);
  double gathered = 0, gathered2 = 0;
  std::uint64_t rays = 0;
  constexpr int samples = test::fewer(200'000);
  const Volume<D>& volume = scene.volumes[0];
  const double domain = std::abs(determinant(tracer.index_to_frame(0)));
  for (int i = 0; i < samples; ++i) {
    Vec<D> position;
    double measure = domain;
    for (int a = 0; a < D; ++a) {
      position[a] = random.uniform() * (volume.field.dims[a] - 1);
      measure *= volume.field.dims[a] - 1;
    }
    const CellPoint<D> at = locate(volume.field, position);
    const double h = interpolate(load_corners(volume.field, at.cell), at.local);
    if (!scene.isovalue_range.contains(h)) continue;
    const SurfacePoint<D> point = tracer.isosurface_point(0, at, h, false);
    if (point.kind() == HitKind::none) continue;
    const double choice = random.uniform(), u = random.uniform();
    const Rgb radiance = lights.direct_radiance(point, choice, {u, random.uniform()}, rays);
    const double flux = average(radiance) * projected_hemisphere<D> *
                        point.isosurface().gradient_length * measure / samples;
    gathered += flux;
    gathered2 += flux * flux;
  }
  // Both are sums of many small independent terms, so they are normally distributed.
  EXPECT_NEAR(landed, gathered, test::z_limit() * std::sqrt(landed2 + gathered2));
  EXPECT_LT(std::sqrt(landed2 + gathered2), (test::sanitized ? 0.3 : 0.03) * gathered);
}

TEST(Lights, PhotonsAgreeWithShadowRays) {
  const Scene<3> empty = test::scene_of(test::ball<3>(33), Rgb(1), IsovalueRange{0.55, 0.9});
  std::vector<Scene<3>> scenes(8, empty);
  scenes[0].lights = {PointLight<3>{"bulb", {0.5, 0.2, 1.2}, 0, Rgb(1), {}}};
  scenes[1].lights = {PointLight<3>{"ball", {0.5, 0.2, 1.2}, 0.2, Rgb(1), {}}};
  const Vec3 down = Vec3(0, 0.3, -0.7).normalized();
  scenes[2].lights = {PointLight<3>{
      "spot", {0.5, 0.2, 1.2}, 0.05, Rgb(1), PointLight<3>::Cone{down, 0.9, 0.5, true}}};
  scenes[3].lights = {SunLight<3>{"sun", down, Rgb(1), 0}};
  scenes[4].lights = {SunLight<3>{"hazy sun", down, Rgb(1), 0.6}};
  scenes[5].environment = Environment<3>{"sky", Rgb(1), nullptr, {}};
  scenes[6].lights = {
      AreaLight<3>{"disc", {0.2, 0.2, 1.3}, {Vec3(0, 0.5, 0), Vec3(0.7, 0, 0)}, Rgb(1), true}};
  scenes[7].meshes = {test::wall("glow", {0.2, 0.2, 1.3}, {0, 0.5, 0}, {0.7, 0, 0}, Rgb(0))};
  scenes[7].meshes[0].emission = Rgb(1);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    SCOPED_TRACE(i);
    expect_photons_agree(scenes[i]);
  }
  const Scene<2> flat = test::scene_of(test::ball<2>(65), Rgb(1), IsovalueRange{0.55, 0.9});
  std::vector<Scene<2>> flat_scenes(4, flat);
  flat_scenes[0].lights = {PointLight<2>{"bulb", {0.5, 1.2}, 0.1, Rgb(1), {}}};
  flat_scenes[1].lights = {SunLight<2>{"sun", Vec<2>(0.6, -0.8), Rgb(1), 0.3}};
  flat_scenes[2].environment = Environment<2>{"sky", Rgb(1), nullptr, {}};
  flat_scenes[3].lights = {PointLight<2>{
      "spot", {0.5, 1.2}, 0.05, Rgb(1), PointLight<2>::Cone{{0, -1}, 0.9, 0.5, false}}};
  for (std::size_t i = 0; i < flat_scenes.size(); ++i) {
    SCOPED_TRACE(i);
    expect_photons_agree(flat_scenes[i]);
  }
}

TEST(Lights, SeveralShareTheSamples) {
  Scene<3> scene = plane(Rgb(1)), first = scene, second = scene;
  const PointLight<3> bulb{"bulb", {0.7, 0.5, -0.4}, 0, Rgb(1), {}};
  const SunLight<3> sun{"sun", {0, 0, 1}, Rgb(0.5f), 0.1};
  scene.lights = {bulb, sun};
  first.lights = {bulb};
  second.lights = {sun};
  expect_irradiance(scene, place,
                    irradiance_at(first, place).mean + irradiance_at(second, place).mean);
}

// Bakes a scene with all kinds of lamps and compares it with path tracing.
TEST(Lights, BakeOfAllAgreesWithPaths) {
  Scene<3> scene = test::cornell(test::ball<3>(41), {0.6, 0.9});
  scene.lights.push_back(PointLight<3>{"bulb", {0.1, -0.1, 0.3}, 0.05, Rgb(0.2f), {}});
  scene.lights.push_back(SunLight<3>{"sun", Vec3(0.2, 1, -0.3).normalized(), Rgb(0.7f), 0.05});
  scene.meshes[2].emission = Rgb(0.2f, 0.1f, 0.1f);
  scene.environment = Environment<3>{"sky", Rgb(0.3f, 0.4f, 0.5f), nullptr, {}};
  scene.volumes[0].emission = ColorRamp({{0.6, Rgb(0)}, {0.9, Rgb(0.2f, 0.2f, 0)}});
  for (const EstimatorName estimator :
       {EstimatorName::gather, EstimatorName::volumetric, EstimatorName::path}) {
    SCOPED_TRACE(static_cast<int>(estimator));
    test::expect_agreement(scene, 0.72, estimator, 64, 2'000'000, 0.01, 0.09);
  }
}

}  // namespace
}  // namespace leaflight
