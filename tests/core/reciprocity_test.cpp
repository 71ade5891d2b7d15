// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that light paths are reversible, and that energy is conserved.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.h"
#include "statistics.h"
#include "transport/photon_tracer.h"

namespace leaflight {
namespace {

// Expects that glass scatters a reversed ray back along its path. Both directions have the same
// share of the radiance over n^2 (over n in the plane).
template <int D>
void expect_reversible() {
  Random random(1);
  SurfacePoint<D> point;
  point.on = MeshHit{};
  point.scattering = Scattering::glass;
  point.albedo = Rgb(0.9f, 0.5f, 0.2f);
  Vec<D> normal(0.0);
  normal[D - 1] = 1;
  point.geometric_normal = point.shading_normal = normal;
  int through = 0;
  for (int i = 0; i < 2000; ++i) {
    point.ior = i % 2 ? 1.5 : 1 / 1.5;
    Vec<D> direction(0.0);
    direction[0] = 2 * random.uniform() - 1;
    direction[D - 1] = -std::sqrt(1 - direction[0] * direction[0]);
    const SpecularBounce<D> forward = specular_bounce<D>(point, direction, random.uniform());
    const bool refracted = forward.direction[D - 1] < 0;
    const SurfacePoint<D>& from = refracted ? forward.from : point;
    // The smallest u reflects and the largest refracts, if both are possible.
    const SpecularBounce<D> back =
        specular_bounce<D>(from, -forward.direction, refracted ? 1 - 1e-12 : 0);
    ASSERT_LT((back.direction + direction).length(), 1e-6);
    ASSERT_NEAR(back.radiance_scale * forward.radiance_scale, 1, 1e-6);
    ASSERT_NEAR(back.weight.x, forward.weight.x, 1e-6);
    if (!refracted) continue;
    ++through;
    EXPECT_NEAR(forward.radiance_scale, std::pow(point.ior, 1 - D), 1e-6);
    const double cosine = -direction[D - 1], other = -forward.direction[D - 1];
    EXPECT_NEAR(fresnel_reflectance(cosine, point.ior), fresnel_reflectance(other, 1 / point.ior),
                1e-9);
  }
  EXPECT_GT(through, 500);
}
TEST(Reciprocity, OfGlass) {
  expect_reversible<2>();
  expect_reversible<3>();
}

// Returns a flat isosurface, whose shading normals are geometric, in a box with two plates and a
// mirror on one side. The first or the second plate emits.
constexpr double plate_area = 0.3 * 0.2;
Scene<3> plates(int emitter, const Field<3>& isosurfaces) {
  Scene<3> scene = test::cornell(isosurfaces, {0.2, 0.8});
  scene.lights.clear();
  scene.meshes[0].scattering = Scattering::mirror;
  scene.meshes.push_back(test::wall("low", {0.1, 0.2, -0.2}, {0.3, 0, 0}, {0, 0.2, 0}, Rgb(0.5f)));
  scene.meshes.push_back(
      test::wall("upright", {0.9, 0.9, -0.1}, {0, -0.3, 0}, {0, 0, 0.2}, Rgb(0.3f)));
  scene.meshes[scene.meshes.size() - 2 + emitter].emission = Rgb(5);
  return scene;
}
Field<3> flat_isosurfaces() {
  return test::sampled<3>(9, [](const Vec3& x) { return x.z; });
}
// Returns isosurfaces with a right-angled fold at every plane of voxels. Central differences do not
// see the folds, so the isosurfaces are shaded like flat ones.
Field<3> creased_isosurfaces() {
  constexpr int n = 17;
  return test::sampled<3>(n, [](const Vec3& x) {
    return x.z + static_cast<double>(std::lround((n - 1) * x.x) % 2) / (n - 1);
  });
}

struct Flux {
  Imath::V3d mean{0}, variance{0};
};

// Returns the flux that both sides of a plate receive, by path tracing from it. The plates emit
// equally.
Flux received(const Scene<3>& scene, int plate, int points) {
  const int mesh = static_cast<int>(scene.meshes.size()) - 2 + plate;
  Random random(3 + plate);
  std::vector<FacetPoint> places;
  for (int i = 0; i < points; ++i) {
    const double root = std::sqrt(random.uniform()), v = random.uniform();
    places.push_back({mesh, i % 2, root * (1 - v), root * v, i % 4 < 2});
  }
  const auto radiance = test::traced(scene, places, 0.5, test::fewer(256), 5 + plate);
  Flux flux;
  const double scale = pi / scene.meshes[mesh].albedo.x * 2 * plate_area;
  for (const auto& r : radiance) flux.mean += Imath::V3d(r.radiance) * (scale / points);
  for (const auto& r : radiance) {
    const Imath::V3d rest = Imath::V3d(r.radiance) * scale - flux.mean;
    flux.variance += rest * rest / (points * (points - 1.0));
  }
  return flux;
}

void expect_same(const Flux& a, const Flux& b, double most_error) {
  if (test::sanitized) return;
  for (int k = 0; k < 3; ++k) {
    const double error = std::sqrt(a.variance[k] + b.variance[k]);
    EXPECT_NEAR(a.mean[k], b.mean[k], test::z_limit(3) * error);
    EXPECT_LT(error, most_error * a.mean[k]);
  }
}

// Two plates must exchange the same flux in both directions, over all paths (Helmholtz).
TEST(Reciprocity, OfTwoPlates) {
  constexpr int points = test::fewer(6000);
  const Flux flux = received(plates(0, flat_isosurfaces()), 1, points);
  const Flux back = received(plates(1, flat_isosurfaces()), 0, points);
  expect_same(flux, back, 0.02);
}

// Photons follow paths in reverse. Shading normals that differ from the normals of the surface
// require a factor (Veach 1997, ch. 5).
TEST(Reciprocity, OfPhotonsAndPaths) {
  const std::vector<Field<3>> fields{flat_isosurfaces(), test::ball<3>(17), creased_isosurfaces()};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    SCOPED_TRACE(i);
    Scene<3> scene = plates(0, fields[i]);
    const Flux paths = received(scene, 1, test::fewer(3000));
    // All photons get the isovalue of the paths.
    const double c = 0.5, height = 1e-6;
    scene.isovalue_range = {c - height / 2, c + height / 2};
    const SceneTracer<3> tracer(scene);
    const LightSampler<3> lights(tracer);
    const int plate = static_cast<int>(scene.meshes.size()) - 1;
    constexpr int batches = 20, count = test::fewer(50'000);
    std::vector<Imath::V3d> sums(batches, Imath::V3d(0));
    Flux photons;
    for (int b = 0; b < batches; ++b) {
      trace_photons(tracer, lights, PhotonPaths::all, 100 + b, 0, count, count,
                    [&](const PhotonHit<3>& hit) {
                      if (hit.point.kind() == HitKind::mesh && hit.point.facet().mesh == plate) {
                        sums[b] += Imath::V3d(hit.flux_height);
                      }
                    });
      photons.mean += sums[b] / batches;
    }
    for (const auto& sum : sums) {
      const Imath::V3d rest = sum - photons.mean;
      photons.variance += rest * rest / (batches * (batches - 1.0));
    }
    expect_same(paths, photons, 0.03);
  }
}

// All emitted energy is absorbed or escapes, apart from the noise of Russian roulette. Shading
// normals do not conserve energy (Veach 1997, ch. 5), so the isosurface is flat.
TEST(Energy, IsConservedWithinItsNoise) {
  Scene<3> scene = plates(0, flat_isosurfaces());
  scene.environment = Environment<3>{"sky", Rgb(0.1f, 0.2f, 0.3f), nullptr, {}};
  const SceneTracer<3> tracer(scene);
  const LightSampler<3> lights(tracer);
  constexpr int batches = 30, count = test::fewer(15'000);
  for (int k = 0; k < 3; ++k) {
    double sum = 0, sum2 = 0;
    for (int b = 0; b < batches; ++b) {
      PhotonBalance balance;
      trace_photons(
          tracer, lights, PhotonPaths::all, 200 + b, 0, count, count, [](const auto&) {}, &balance);
      const double lost = 1 - (balance.absorbed[k] + balance.escaped[k]) / balance.emitted[k];
      sum += lost / batches;
      sum2 += lost * lost / batches;
    }
    const double error = std::sqrt((sum2 - sum * sum) / (batches - 1));
    if (test::sanitized) continue;
    EXPECT_LT(std::abs(test::z_of_t(sum / error, batches - 1)), test::z_limit(3)) << k;
    EXPECT_LT(error, 0.002);
  }
}

}  // namespace
}  // namespace leaflight
