// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/photon_map.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "agreement.h"
#include "base/error.h"
#include "base/sampling.h"
#include "surface/project.h"
#include "thesis/thesis_estimator.h"
#include "transport/isosurface_cache.h"

namespace leaflight {
namespace {

TEST(DensityRegion, WithoutClippingTheClosedFormIsTheSpheres) {
  const double d = 0.3, kappa = 7;
  EXPECT_NEAR(sphere_volume<3>(d, kappa), 4.0 / 3 * pi * d * d * d / kappa, 1e-15);
  EXPECT_NEAR(sphere_volume<2>(d, kappa), pi * d * d / kappa, 1e-15);
  for (const double c : {d / kappa, 2 * d}) {
    EXPECT_NEAR(clipped_sphere_volume<3>(d, kappa, -c, c), sphere_volume<3>(d, kappa), 1e-15);
    EXPECT_NEAR(clipped_sphere_volume<2>(d, kappa, -c, c), sphere_volume<2>(d, kappa), 1e-15);
  }
  EXPECT_NEAR(clipped_sphere_volume<3>(d, kappa, 0, d), sphere_volume<3>(d, kappa) / 2, 1e-15);
  EXPECT_NEAR(clipped_sphere_volume<2>(d, kappa, 0, d), sphere_volume<2>(d, kappa) / 2, 1e-15);
  // On a steep field the ellipsoid becomes the sphere.
  EXPECT_NEAR(graph_volume<3>(d, kappa, 1e9), sphere_volume<3>(d, kappa), 1e-15);
}

TEST(DensityRegion, UnknownNamesAreErrors) {
  EXPECT_EQ(density_region_from("cylinder"), DensityRegion::cylinder);
  EXPECT_THROW(density_region_from("ball"), Error);
}

TEST(KdTree, FindsTheNearest) {
  Random random(1);
  std::vector<KdTree<3>::Point> points(2000);
  for (auto& p : points) {
    for (float& x : p) x = static_cast<float>(random.uniform());
  }
  const KdTree<3> tree(points);
  std::vector<Neighbor> found;
  for (int i = 0; i < 50; ++i) {
    const KdTree<3>::Query query{random.uniform(), random.uniform(), random.uniform()};
    std::vector<double> all;
    for (const auto& p : points) {
      all.push_back(std::pow(p[0] - query[0], 2) + std::pow(p[1] - query[1], 2) +
                    std::pow(p[2] - query[2], 2));
    }
    std::sort(all.begin(), all.end());
    tree.nearest(query, 20, 1e9, found);
    std::vector<double> distances;
    for (const Neighbor& n : found) distances.push_back(n.distance2);
    std::sort(distances.begin(), distances.end());
    ASSERT_EQ(distances.size(), 20u);
    for (int k = 0; k < 20; ++k) ASSERT_DOUBLE_EQ(distances[k], all[k]);
    tree.nearest(query, 20, all[7], found);
    ASSERT_EQ(found.size(), 7u);
  }
  KdTree<2>({}).nearest({0, 0}, 5, 1e9, found);
  EXPECT_TRUE(found.empty());
}

// Returns uniform photons on the isosurfaces of h = slope * (last coordinate), with the irradiance
// 1 outside and 3 inside.
template <int D>
std::vector<StoredPhoton<D>> plane_photons(int n, double slope, std::uint64_t seed) {
  std::vector<StoredPhoton<D>> photons(2 * n);
  Random random(seed);
  for (int i = 0; i < 2 * n; ++i) {
    for (int a = 0; a < D; ++a) {
      photons[i].position[a] = static_cast<float>(random.uniform() - 0.5);
    }
    photons[i].c = static_cast<float>(slope * photons[i].position[D - 1]);
    photons[i].back = i % 2;
    photons[i].direct = false;
    // |grad h| dV = dA dc.
    photons[i].flux_height = Rgb(static_cast<Real>((i % 2 ? 3 : 1) * slope / n));
  }
  return photons;
}

// Returns the mean of irradiance estimates in the middle of the domain; the true irradiance is 1.
template <int D>
double mean_irradiance(const PhotonMap<D>& map, double slope, bool back) {
  Random random(9);
  Vec<D> gradient(0.0);
  gradient[D - 1] = slope;
  double sum = 0;
  constexpr int points = 4000;
  for (int i = 0; i < points; ++i) {
    Vec<D> x;
    for (int a = 0; a < D; ++a) x[a] = 0.7 * (random.uniform() - 0.5);
    sum += map.irradiance(x, slope * x[D - 1], back, gradient).x;
  }
  return sum / points;
}

template <int D>
void check_plane(double g, DensityRegion region, double expected, double tolerance) {
  constexpr double slope = 100;
  PhotonMapSettings settings;
  settings.g = g;
  settings.region = region;
  const PhotonMap<D> map(plane_photons<D>(D == 3 ? 400'000 : 100'000, slope, 5), 1, slope,
                         settings);
  EXPECT_NEAR(mean_irradiance(map, slope, false), expected, tolerance);
  EXPECT_NEAR(mean_irradiance(map, slope, true), 3 * expected, 3 * tolerance);
}

// Computes 4000 overlapping estimates of 200 photons each; the standard error is about 0.3 %.
template <class Dimension>
class PlanePhotons : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PlanePhotons, Dimensions);

TYPED_TEST(PlanePhotons, HaveTheBiasesStated) {
  constexpr int D = TypeParam::value;
  constexpr double all = 200.0 / 199;       // all k photons count
  for (const double slope : {1.0, 10.0}) {  // kappa |grad h| = g
    const double counted = slope / std::sqrt(1 + slope * slope);
    check_plane<D>(slope, DensityRegion::sphere, all * counted, 0.01);
    check_plane<D>(slope, DensityRegion::graph, all, 0.01);
    check_plane<D>(slope, DensityRegion::box, 1, 0.015);
    check_plane<D>(slope, DensityRegion::cylinder, 1, 0.015);
  }
  // The clip uses the isovalues of the found photons instead of the true ends, so the volume is
  // slightly too small.
  check_plane<D>(10, DensityRegion::clipped_sphere, 1.01, 0.015);
}

Scene<3> lit_ball() { return test::cornell(test::ball<3>(41), {0.6, 0.9}); }

template <int D>
Vec<D> on_sphere(Random& random) {
  if constexpr (D == 3) {
    return test::random_direction(random);
  } else {
    const double angle = 2 * pi * random.uniform();
    return {std::cos(angle), std::sin(angle)};
  }
}

template <int D>
std::vector<StoredPhoton<D>> photons_of(const SceneTracer<D>& tracer, std::uint64_t count) {
  const LightSampler<D> lights(tracer);
  Progress progress;
  return collect_photons(tracer, lights, 1, count, progress);
}

struct Expected {
  DensityRegion region;
  double ratio;
};
// Stated biases: the last photon adds 0.5 %; the sphere is 0.5 % too large at kappa |grad h| = 10;
// the clip at the found photons adds 1 %.
const std::vector<Expected> stated{{DensityRegion::sphere, 1},
                                   {DensityRegion::clipped_sphere, 1.015},
                                   {DensityRegion::box, 1},
                                   {DensityRegion::cylinder, 1},
                                   {DensityRegion::graph, 1.005}};

// Returns the ratio of the mean indirect radiance over many isosurfaces to that of IsosurfaceCache
// with the same photons.
template <int D>
void compare_with_volumetric(const Scene<D>& scene, std::uint64_t count) {
  if (test::sanitized) count /= 32;
  const SceneTracer<D> tracer(scene);
  const LightSampler<D> lights(tracer);
  Progress progress;
  const Field<D>& field = test::field_of(scene);
  const TexelLattice<D> lattice =
      make_lattice(field, field.dims, scene.isovalue_range.min, scene.isovalue_range.max);
  IsosurfaceCache<D> cache(tracer, 0, lattice, SideContents::nothing, false, false,
                           lights.largest_flux_height() / static_cast<double>(count), count);
  trace_photons(tracer, lights, PhotonPaths::all, 1, 0, count, count,
                [&](const PhotonHit<D>& photon) {
                  if (photon.point.kind() == HitKind::isosurface) cache.deposit(photon);
                });
  cache.finish(progress);
  const std::vector<IsosurfaceRadiance<D>> isosurfaces{{&lattice, &cache}};
  const auto volumetric = make_volumetric_estimator<D>(isosurfaces, nullptr);
  const std::vector<StoredPhoton<D>> photons = photons_of(tracer, count);
  for (const Expected& expected : stated) {
    PhotonMapSettings settings;
    settings.region = expected.region;
    const auto thesis =
        make_thesis_estimator<D>(make_photon_maps(tracer, photons, settings), nullptr);
    Random random(4);
    double sum = 0, other = 0;
    std::uint64_t rays = 0;
    for (int i = 0; i < test::fewer(5000); ++i) {
      const double c = 0.63 + 0.24 * random.uniform();
      const Vec<D> x =
          project_to_isosurface(field, Vec<D>(0.5) + on_sphere<D>(random) * (1 - c), c);
      const SurfacePoint<D> point =
          tracer.isosurface_point(0, locate(field, field.world_to_index.point(x)), c, false);
      sum += average(thesis->indirect_radiance(point, {0, 0}, random, rays));
      other += average(volumetric->indirect_radiance(point, {0, 0}, random, rays));
    }
    EXPECT_EQ(rays, 0u);
    if (test::sanitized) continue;
    EXPECT_NEAR(sum / other, expected.ratio, 0.012)
        << "region " << static_cast<int>(expected.region);
  }
}

TEST(ThesisEstimator, AgreesWithTheVolumetricOne) {
  compare_with_volumetric(lit_ball(), 2'000'000);
}

TEST(ThesisEstimator, AgreesWithTheVolumetricOneInThePlane) {
  compare_with_volumetric(test::flat_cornell(), 1'000'000);
}

TEST(PhotonMap, RadiusLimitsTheSearch) {
  constexpr double slope = 100;
  PhotonMapSettings settings;
  settings.region = DensityRegion::graph;
  settings.radius = 0.02;  // about 13 of 400,000 photons
  const PhotonMap<3> map(plane_photons<3>(400'000, slope, 5), 1, slope, settings);
  EXPECT_NEAR(mean_irradiance(map, slope, false), 1, 0.02);
}

TEST(PhotonMap, CountsDirectPhotonsIfAsked) {
  constexpr double slope = 100;
  auto photons = plane_photons<3>(100'000, slope, 5);
  for (auto& photon : photons) photon.direct = true;
  PhotonMapSettings settings;
  EXPECT_EQ(mean_irradiance(PhotonMap<3>(photons, 1, slope, settings), slope, false), 0);
  settings.direct = true;
  EXPECT_NEAR(mean_irradiance(PhotonMap<3>(photons, 1, slope, settings), slope, false), 1, 0.03);
}

TEST(PhotonMap, EmptyMapIsDark) {
  const PhotonMap<3> map({}, 1, 1, {});
  EXPECT_EQ(map.size(), 0u);
  EXPECT_EQ(map.irradiance(Vec3(0.0), 0, false, Vec3(1, 0, 0)), Rgb(0));
}

TEST(PhotonMap, BadSettingsAreErrors) {
  PhotonMapSettings settings;
  settings.k = 1;
  EXPECT_THROW(PhotonMap<3>({}, 1, 1, settings), Error);
  settings = {};
  settings.g = 0;
  EXPECT_THROW(PhotonMap<2>({}, 1, 1, settings), Error);
  settings = {};
  settings.radius = -1;
  EXPECT_THROW(PhotonMap<2>({}, 1, 1, settings), Error);
}

TEST(PhotonMap, IsTheSameForAnyNumberOfThreads) {
  const Scene<3> scene = lit_ball();
  const SceneTracer<3> tracer(scene);
  std::vector<StoredPhoton<3>> one, all = photons_of(tracer, 50'000);
  tbb::task_arena(1).execute([&] { one = photons_of(tracer, 50'000); });
  ASSERT_EQ(one.size(), all.size());
  ASSERT_GT(one.size(), 5000u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].position, all[i].position);
    ASSERT_EQ(one[i].flux_height, all[i].flux_height);
  }
}

}  // namespace
}  // namespace leaflight
