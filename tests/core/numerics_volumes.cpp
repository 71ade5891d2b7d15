// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sampling.h"
#include "figures.h"

namespace leaflight {
namespace {

// Returns a field of h at voxels, scaled so that the longest side of its box is 1.
Field<3> field_of(const Index<3>& dims, const std::function<double(int, int, int)>& h,
                  Affine<3> transform = test::unit_cube<3>(2)) {
  std::vector<float> values;
  for_each_index<3>({0, 0, 0}, dims, [&](const Index<3>& i) {
    values.push_back(static_cast<float>(h(i[0], i[1], i[2])));
  });
  const Field<3> measured = test::field_from<3>(values, dims, transform);
  const Box<3> box = world_box(measured);
  const double scale = 1 / box.longest_side();
  for (Vec3& column : transform.column) column *= scale;
  transform.origin = (transform.origin - (box.low + box.high) * 0.5) * scale + Vec3(0.5);
  return test::field_from<3>(std::move(values), dims, transform);
}

struct Case {
  std::string name;
  Field<3> field;
  IsovalueRange isovalue_range;
};

double ball(int i, int j, int k) { return 1 - (Vec3(i, j, k) / 12 - Vec3(0.5)).length(); }

std::vector<Case> cases() {
  const Index<3> cube{13, 13, 13};
  Random random(107);
  const auto any = [&](int, int, int) { return random.uniform(); };
  const auto scaled = [](double a, double b) {
    return [a, b](int i, int j, int k) { return a * ball(i, j, k) + b; };
  };
  const auto integers = [&](int, int, int) { return std::floor(256 * random.uniform()); };
  const auto steps = [](int i, int j, int k) { return std::floor(4 * ball(i, j, k)); };
  const auto thin = [](int, int, int k) { return k == 6 ? 1.0 : 0.0; };
  const auto spike = [](int i, int j, int k) { return i == 6 && j == 6 && k == 6 ? 1.0 : 0.0; };
  const auto board = [](int i, int j, int k) { return (i + j + k) % 2; };
  const auto critical = [](int i, int j, int k) {
    return std::sin(pi * i / 3.0) * std::sin(pi * j / 3.0) * std::sin(pi * k / 3.0);
  };
  const auto saddle = [](int i, int j, int k) {
    const double x = i - 6.0, y = j - 6.0, z = k - 6.0;
    return x * x + y * y - 2 * z * z;
  };
  const auto holes = [&](int i, int j, int k) {
    return random.uniform() < 0.05 ? std::nan("") : ball(i, j, k);
  };
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {
      {"values 1e-30", field_of(cube, scaled(1e-30, 0)), {0.6e-30, 0.9e-30}},
      {"values 1e30", field_of(cube, scaled(1e30, 0)), {0.6e30, 0.9e30}},
      {"negative values", field_of(cube, scaled(1, -7)), {-6.4, -6.1}},
      // This isovalue range contains 8 numbers of single precision.
      {"1e6 and 0.5", field_of(cube, scaled(1, 1e6)), {1e6 + 0.5, 1e6 + 1}},
      {"1000 and 1e-3", field_of(cube, scaled(1e-3, 1000)), {1000.0006, 1000.0009}},
      {"values 1e-30 to 1e30",
       field_of(cube, [&](int, int, int) { return std::pow(10, 60 * random.uniform() - 30); }),
       {1e-30, 1e30}},
      {"8 bits at integers", field_of(cube, integers), {100, 101}},
      {"plateaus", field_of(cube, steps), {1, 3}},
      {"wall of one voxel", field_of(cube, thin), {0.2, 0.9}},
      {"one voxel", field_of(cube, spike), {0.2, 0.9}},
      {"checkerboard", field_of(cube, board), {0.2, 0.8}},
      {"noise", field_of(cube, any), {0.3, 0.7}},
      {"all isovalues", field_of(cube, ball), {1 - std::sqrt(0.75), 1}},
      {"beyond the isovalues", field_of(cube, ball), {-1e3, 1e3}},
      {"narrow isovalue range", field_of(cube, ball), {0.7, 0.7 + 1e-12}},
      {"critical points", field_of(cube, critical), {-0.65, 0.65}},
      {"saddle", field_of(cube, saddle), {-1e-3, 1e-3}},
      {"2 x 2 x 2", field_of({2, 2, 2}, any), {0.3, 0.7}},
      {"2 x 7 x 5", field_of({2, 7, 5}, any), {0.3, 0.7}},
      {"9 x 2 x 30", field_of({9, 2, 30}, any), {0.3, 0.7}},
      {"spacing 1:1:100", field_of(cube, ball, {{x, y, z * 100}}), {0.6, 0.9}},
      {"sheared", field_of(cube, ball, {{x, x * 5 + y, x - y * 3 + z}}), {0.6, 0.9}},
      {"mirrored", field_of(cube, ball, {{-x, y, z}}), {0.6, 0.9}},
      {"voxels without data", field_of(cube, holes), {0.5, 0.9}},
  };
}

// Returns a scene of the field under a lamp and a dim sky.
Scene<3> lit(const Field<3>& field, const IsovalueRange& isovalue_range) {
  Scene<3> scene = test::scene_of(field, Rgb(0.75f), isovalue_range);
  scene.lights = {
      AreaLight<3>{"lamp", {0.2, 0.2, 1.28}, {Vec3(0, 0.6, 0), Vec3(0.6, 0, 0)}, Rgb(3)}};
  scene.environment = Environment<3>{"sky", Rgb(0.1f), nullptr, {}};
  return scene;
}

FixedSettings<3> quick(EstimatorName estimator) {
  auto settings = test::fixed_settings<3>(estimator, 2, test::fewer(5000));
  settings.both_sides = true;
  return settings;
}

const std::vector<EstimatorName> estimators{EstimatorName::gather, EstimatorName::volumetric,
                                            EstimatorName::path, EstimatorName::thesis};

bool is_light(const std::vector<Vec<3, float>>& radiance) {
  return std::all_of(radiance.begin(), radiance.end(), [](const Vec<3, float>& r) {
    return std::isfinite(r.x + r.y + r.z) && r.x >= 0 && r.y >= 0 && r.z >= 0;
  });
}

// Expects finite light that is not negative, and not zero everywhere.
void expect_light(const Scene<3>& scene, const std::string& name) {
  for (const EstimatorName estimator : estimators) {
    const RadianceGrid<3> grid = test::baked(scene, quick(estimator)).grids[0];
    const std::string what = name + ", " + traits_of(estimator).name;
    EXPECT_TRUE(is_light(grid.radiance)) << what;
    EXPECT_TRUE(is_light(grid.radiance_indirect)) << what;
    EXPECT_TRUE(is_light(grid.radiance_back)) << what;
    for (const float e : grid.radiance_error) ASSERT_TRUE(std::isfinite(e) && e >= 0) << what;
    double sum = 0;
    for (const auto& side : {grid.radiance, grid.radiance_back}) {
      for (const auto& r : side) sum += r.x + r.y + r.z;
    }
    EXPECT_GT(sum, 0) << what;
  }
}

TEST(NumericsVolumes, BakesAreFinite) {
  for (const Case& hard : cases()) expect_light(lit(hard.field, hard.isovalue_range), hard.name);
}

// Bakes all isosurfaces of two volumes whose values differ by 60 decades.
TEST(NumericsVolumes, TwoRangesAreFinite) {
  std::vector<Case> all = cases();
  Scene<3> scene = lit(all[0].field, {0.6, 0.9});
  scene.volumes[0].scale = 1e-30;
  scene.volumes.push_back(scene.volumes[0]);
  scene.volumes[1].field = all[1].field;
  scene.volumes[1].scale = 1e30;
  expect_light(scene, "two ranges");
}

// The lamp lies on an isosurface, inside one, or touches one with its edge.
TEST(NumericsVolumes, LightOnAnIsosurface) {
  const Field<3> field = test::sampled<3>(13, [](const Vec3& x) { return x.z; });
  Scene<3> scene = lit(field, {0.2, 0.8});
  scene.environment.reset();
  const Vec3 x(0.5, 0, 0), y(0, 0.5, 0), z(0, 0, 0.5);
  scene.lights = {AreaLight<3>{"in an isosurface", {0.25, 0.25, 0.5}, {x, y}, Rgb(1)}};
  expect_light(scene, "lamp in an isosurface, shining up");
  scene.lights = {AreaLight<3>{"in an isosurface", {0.25, 0.25, 0.5}, {y, x}, Rgb(1)}};
  expect_light(scene, "lamp in an isosurface, shining down");
  scene.lights = {AreaLight<3>{"on edge", {0.25, 0.5, 0.25}, {x, z}, Rgb(1)}};
  expect_light(scene, "lamp across isosurfaces");
  for (const double radius : {0.0, 1e-12, 0.1}) {
    scene.lights = {PointLight<3>{"bulb", Vec3(0.5), radius, Rgb(1), {}}};
    expect_light(scene, "bulb in an isosurface");
  }
}

// An isosurface lies in the plane of a wall, on either side of it, or crosses it.
TEST(NumericsVolumes, IsosurfaceOnAWall) {
  const Field<3> field = test::sampled<3>(13, [](const Vec3& x) { return x.z; });
  Scene<3> scene = lit(field, {0.499, 0.501});
  const Vec3 x(0.6, 0, 0), y(0, 0.6, 0), z(0, 0, 0.6);
  scene.meshes = {test::wall("in an isosurface", {0.2, 0.2, 0.5}, x, y, Rgb(0.5f))};
  expect_light(scene, "wall in an isosurface");
  scene.meshes.back() = test::wall("across isosurfaces", {0.2, 0.5, 0.2}, x, z, Rgb(0.5f));
  expect_light(scene, "wall across isosurfaces");
}

std::vector<std::pair<std::string, Affine<3>>> any_transform() {
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {{"plain", {{x, y, z}}},
          {"mirrored", {{-x, y, z}}},
          {"spacing 1:1:100", {{x, y, z * 100}}},
          {"spacing 100:1:1", {{x * 100, y, z}}},
          {"sheared", {{x, x * 5 + y, x - y * 3 + z}}},
          {"sheared, mirrored, 1:1:100", {{-x, x * 5 + y, (x - y * 3 + z) * 100}}}};
}

// In a closed box of radiance 1 and albedo 1/2, everything white has the radiance 2. The
// isosurfaces are planes, whose shading normals equal the geometric ones.
Scene<3> furnace_of_planes(const Affine<3>& transform) {
  const auto h = [](int i, int j, int k) { return i + 2 * j + 3 * k; };
  return test::furnace(field_of({9, 9, 9}, h, transform), {20, 28}, 1, static_cast<Real>(0.5));
}

TEST(NumericsVolumes, FurnaceInAnyTransform) {
  for (const auto& [name, transform] : any_transform()) {
    const Scene<3> scene = furnace_of_planes(transform);
    FixedSettings<3> settings = quick(EstimatorName::path);
    settings.samples = static_cast<int>(test::trials(64, 1024));
    const RadianceGrid<3> grid = test::baked(scene, settings).grids[0];
    double sum = 0, variance = 0, texels = 0;
    for (std::size_t s = 0; s < grid.radiance.size(); ++s) {
      // Black texels are active, but no isosurface of the isovalue range reaches their box.
      texels += grid.radiance[s].x > 0;
      sum += grid.radiance[s].x;
      variance += grid.radiance_error[s] * grid.radiance_error[s];
    }
    const double z_score = (sum - 2 * texels) / std::sqrt(variance);
    if (!test::sanitized) {
      EXPECT_GT(texels, 0.9 * static_cast<double>(grid.radiance.size())) << name;
      // Six tests share a significance of 1e-4.
      EXPECT_LT(std::abs(z_score), 4.3) << name;
    }
    test::figure("furnace, " + name + ": mean radiance over 2", sum / texels / 2);
    test::figure("furnace, " + name + ": z-score", z_score);
  }
}

// The photon density divides by the area of isosurfaces, which depends on gradients. Gradients in
// the wrong space would change it by the ratio of the axes. The mean of four seeds has a noise of
// about 2 %.
TEST(NumericsVolumes, PhotonsInAnyTransform) {
  constexpr int seeds = 4;
  for (const auto& [name, transform] : any_transform()) {
    double sum = 0, texels = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      FixedSettings<3> settings = quick(EstimatorName::volumetric);
      settings.photons = test::fewer(400'000);
      settings.seed = seed;
      const RadianceGrid<3> grid = test::baked(furnace_of_planes(transform), settings).grids[0];
      for (const auto& radiance : grid.radiance) {
        texels += radiance.x > 0;
        sum += radiance.x;
      }
    }
    const double mean = sum / texels / 2;
    if (!test::sanitized) {
      EXPECT_NEAR(mean, 1, 0.1) << name;
    }
    test::figure("furnace of photons, " + name + ": mean radiance over 2", mean);
  }
}

// In any narrow isovalue range, the radiance must be 2 on all isosurfaces.
TEST(NumericsVolumes, FurnaceInNarrowRanges) {
  for (const double height : {1e-2, 1e-3, 1e-12}) {
    for (const EstimatorName estimator : estimators) {
      const Scene<3> scene = test::furnace(
          test::ball<3>(25), {0.72 - height / 2, 0.72 + height / 2}, 1, static_cast<Real>(0.5));
      FixedSettings<3> settings = quick(estimator);
      settings.samples = test::fewer(16);
      settings.photons = test::fewer(100'000);
      settings.both_sides = false;
      const Baked<3> baked = test::baked(scene, settings);
      const std::vector<Vec3> points = test::isosurface_points(test::field_of(scene), 0.72, 5);
      double sum = 0, square = 0;
      for (const Vec3& point : points) {
        const double radiance = test::lookup_world(scene, baked, point).x;
        sum += radiance;
        square += radiance * radiance;
      }
      const auto n = static_cast<double>(points.size());
      const double mean = sum / n, error = std::sqrt((square / n - mean * mean) / n);
      std::ostringstream what;
      what << "furnace, isovalue range of " << height << ", " << traits_of(estimator).name;
      // Neighboring points share texels and photons, so eight count as one. Shading normals cost 1
      // %.
      if (!test::sanitized) {
        EXPECT_LT(std::abs(mean - 2), 4 * std::sqrt(8) * error + 0.02) << what.str();
      }
      test::figure(what.str() + ": mean radiance over 2", mean / 2);
      test::figure(what.str() + ": its standard error", error / 2);
    }
  }
}

// A mirrored ball must have the same lit texels, with the same light except for noise.
TEST(NumericsVolumes, StoredTheOtherWayRound) {
  Affine<3> mirror{{Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}};
  const auto off_center = [](int i, int j, int k) { return ball(i + 2, j, k - 1); };
  const auto reversed = [&](int i, int j, int k) { return off_center(12 - i, j, k); };
  FixedSettings<3> settings = quick(EstimatorName::path);
  settings.samples = test::fewer(64);
  const auto baked = [&](const Field<3>& field) {
    return test::baked(test::cornell(field, {0.6, 0.9}), settings).grids[0];
  };
  const RadianceGrid<3> a = baked(field_of({13, 13, 13}, off_center)),
                        b = baked(field_of({13, 13, 13}, reversed, mirror));
  ASSERT_EQ(a.radiance.size(), b.radiance.size());
  double difference = 0, variance = 0, sum = 0;
  for (std::size_t s = 0; s < a.radiance.size(); ++s) {
    Index<3> texel = a.lattice.texel(a.lattice.active[s]);
    texel[0] = 12 - texel[0];
    const std::int32_t other = b.lattice.slot[b.lattice.linear(texel)];
    ASSERT_NE(other, TexelLattice<3>::inactive);
    const Vec<3, float> r = a.radiance[s], q = b.radiance[other];
    sum += (r.x + r.y + r.z) / 3;
    difference += (q.x + q.y + q.z - r.x - r.y - r.z) / 3;
    variance += std::pow(a.radiance_error[s], 2) + std::pow(b.radiance_error[other], 2);
  }
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(variance));
  test::figure("stored the other way round: ratio of the means", 1 + difference / sum);
  test::figure("stored the other way round: its standard error", std::sqrt(variance) / sum);
}

}  // namespace
}  // namespace leaflight
