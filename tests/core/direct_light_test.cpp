// SPDX-License-Identifier: GPL-3.0-or-later
// Tests direct light from visibility maps against shadow rays.
#include "bake/direct/direct_light.h"

#include <gtest/gtest.h>

#include "agreement.h"
#include "bake/texels/line_volume.h"

namespace leaflight {
namespace {

Progress ignored;

template <int D>
AreaLight<D> lamp_above() {
  if constexpr (D == 3) {
    return {"lamp", {0.2, 0.3, 1.4}, {Vec3(0, 0.6, 0), Vec3(0.4, 0, 0)}, Rgb(3, 2, 1)};
  } else {
    return {"lamp", {0.8, 1.4}, {Vec<2>(-0.6, 0.0)}, Rgb(3, 2, 1)};
  }
}

template <int D>
Vec<D> along_all(double first, double rest) {
  Vec<D> v(rest);
  v[0] = first;
  return v;
}

template <int D>
PointLight<D> point_light(const Vec<D>& position) {
  return {"point", position, 0, Rgb(1.0f), {}};
}

// Returns a field with two bumps, so that isosurfaces cast shadows on themselves.
template <int D>
Field<D> bumps(int n) {
  return test::sampled<D>(n, [](const Vec<D>& x) {
    const double a = (x - along_all<D>(0.3, 0.35)).length2();
    const double b = (x - along_all<D>(0.65, 0.68)).length2();
    return std::exp(-18 * a) + 0.8 * std::exp(-40 * b);
  });
}

// Compares direct light at random points of random isosurfaces with shadow rays to the same light
// points. Returns the RMS difference over the RMS of the truth, and the ratio of the means.
template <int D>
test::Agreement against_rays(const Scene<D>& scene, bool back) {
  const SceneTracer<D> tracer(scene);
  const SplitLight<D> split = split_light(tracer);
  const DirectLight<D> direct(tracer, 0, split.points, {scene.volumes[0].field.dims, back},
                              ignored);
  const Field<D>& field = scene.volumes[0].field;
  Random random(7, 1, D);
  double difference = 0, square = 0, found_sum = 0, true_sum = 0;
  for (int i = 0; i < (test::sanitized ? 300 : 4000); ++i) {
    Vec<D> position;
    for (int a = 0; a < D; ++a) position[a] = random.uniform() * (field.dims[a] - 1);
    const CellPoint<D> at = locate(field, position);
    const double h = interpolate(load_corners(field, at.cell), at.local);
    const double c = scene.volumes[0].common_isovalue(h);
    if (!scene.isovalue_range.contains(c)) continue;
    const SurfacePoint<D> point = tracer.isosurface_point(0, at, c, back);
    if (point.kind() == HitKind::none) continue;
    double truth = 0;
    for (const LightPoint<D>& light : split.points) {
      const LightSource<D>& source = light.source;
      const Vec<D> direction =
          source.infinite ? source.direction : point.position - source.position;
      const double distance = source.infinite ? 1 : direction.length();
      const Vec<D> unit = direction / direction.length();
      const double cosine = -unit.dot(point.shading_normal);
      if (!(cosine > 0 && unit.dot(point.geometric_normal) < 0)) continue;
      const bool hidden = source.infinite ? tracer.occluded(point, -unit)
                                          : tracer.occluded(point, source.position,
                                                            source.sphere ? unit : source.normal);
      if (hidden) continue;
      truth += average(point.albedo * source.amount) * source.strength(unit, distance) * cosine /
               projected_hemisphere<D>;
    }
    const double found = average(direct.radiance(field, position, back));
    difference += (found - truth) * (found - truth);
    square += truth * truth;
    found_sum += found;
    true_sum += truth;
  }
  return {found_sum / true_sum, std::sqrt(difference / square)};
}

template <int D>
Scene<D> lit(Field<D> field, const IsovalueRange& isovalue_range, const Light<D>& light) {
  Scene<D> scene = test::scene_of(std::move(field), Rgb(0.8f, 0.6f, 0.4f), isovalue_range);
  scene.lights.push_back(light);
  return scene;
}

template <int D>
void expect_shadows(const char* name, const Scene<D>& scene, bool back = false,
                    double most = 0.06) {
  const test::Agreement found = against_rays(scene, back);
  EXPECT_NEAR(found.mean_ratio, 1, 0.015) << name << " in " << D << " dimensions";
  EXPECT_LT(found.relative_rms, most) << name << " in " << D << " dimensions";
}

template <int D>
void expect_shadows_of_all_lights(int n) {
  const IsovalueRange isovalue_range{0.2, 0.9};
  expect_shadows<D>("above", lit<D>(bumps<D>(n), isovalue_range, lamp_above<D>()));
  expect_shadows<D>("beside",
                    lit<D>(bumps<D>(n), isovalue_range, point_light<D>(along_all<D>(-0.4, 0.9))));
  expect_shadows<D>("within",
                    lit<D>(bumps<D>(n), isovalue_range, point_light<D>(along_all<D>(0.9, 0.15))));
  Vec<D> oblique = along_all<D>(0.8, 0.3);
  oblique[D - 1] = -1;
  expect_shadows<D>("sun", lit<D>(bumps<D>(n), isovalue_range,
                                  SunLight<D>{"sun", oblique.normalized(), Rgb(1.0f)}));
  expect_shadows<D>("sun along an axis", lit<D>(bumps<D>(n), isovalue_range,
                                                SunLight<D>{"sun", along_all<D>(-1, 0), Rgb(1)}));
}

TEST(DirectLightOfIsosurfaces, HasTheShadowsOfRays) { expect_shadows_of_all_lights<3>(41); }

TEST(DirectLightOfIsosurfaces, HasThemInThePlane) { expect_shadows_of_all_lights<2>(121); }

TEST(DirectLightOfIsosurfaces, HasThoseOfMeshes) {
  Scene<3> scene = lit<3>(bumps<3>(41), {0.2, 0.9}, point_light<3>({0.5, 0.5, 1.6}));
  scene.meshes.push_back(
      test::wall("plate", {0.1, 0.1, 1.1}, {0.35, 0, 0}, {0, 0.9, 0}, Rgb(0.5f)));
  expect_shadows("a plate before the light", scene, false, 0.1);
  // Put a wall through the volume. Results within a texel of it may be wrong.
  scene.meshes = {test::wall("wall", {0.75, -0.2, -0.2}, {0, 1.4, 0}, {0, 0, 1.4}, Rgb(0.5f))};
  expect_shadows("a wall within", scene, false, 0.15);
}

TEST(DirectLightOfIsosurfaces, HasThoseOfBacks) {
  // The field has the shape of a bowl, and light enters it from above.
  const Field<3> bowl =
      test::sampled<3>(41, [](const Vec3& x) { return 1.1 - (x - Vec3(0.5, 0.5, 0.9)).length(); });
  expect_shadows("bowl", lit<3>(bowl, {0.55, 0.9}, point_light<3>({0.5, 0.45, 1.3})), true, 0.1);
}

TEST(DirectLightOfIsosurfaces, HasThemWhereVoxelsAreNoCubes) {
  Field<3> field = bumps<3>(41);
  Affine<3> sheared = field.index_to_world;
  sheared.column[0] *= 1.7;
  sheared.column[1] += sheared.column[0] * 0.3;
  sheared.column[2] *= -0.6;
  Field<3> stretched = test::field_from<3>(test::values_of(field), field.dims, sheared);
  expect_shadows("sheared", lit<3>(stretched, {0.2, 0.9}, point_light<3>({1.5, 0.4, 1.2})));
}

TEST(DirectLightOfIsosurfaces, IsTheSameForAnyIsovalueUnits) {
  // Test bytes, and common isovalues with an offset and a scale.
  const Field<3> field = bumps<3>(33);
  std::vector<std::uint8_t> bytes;
  for (const float h : test::values_of(field)) {
    bytes.push_back(static_cast<std::uint8_t>(std::lround(200 * h)));
  }
  const auto owner = std::make_shared<std::vector<std::uint8_t>>(std::move(bytes));
  Scene<3> scene = lit<3>(make_field<3>(owner->data(), field.dims, field.index_to_world, owner),
                          {0.2, 0.9}, lamp_above<3>());
  scene.volumes[0].scale = 200;
  expect_shadows("bytes", scene);
}

TEST(DirectLightOfIsosurfaces, PassesOverMaskedVoxels) {
  std::vector<float> values = test::values_of(bumps<3>(33));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % 33 > 28) values[i] = std::numeric_limits<float>::quiet_NaN();
  }
  const Field<3> field =
      test::field_from<3>(std::move(values), {33, 33, 33}, test::unit_cube<3>(33));
  expect_shadows("masked", lit<3>(field, {0.2, 0.9}, lamp_above<3>()));
}

// Returns a scene with a lamp above the volume, which tests move, and a point light that stays.
template <int D>
std::vector<Light<D>> lights_after(double moved) {
  AreaLight<D> lamp = lamp_above<D>();
  lamp.corner[0] += moved;
  return {point_light<D>(along_all<D>(-0.4, 0.9)), lamp};
}

template <int D>
DirectLight<D> maps_of(const Scene<D>& scene, int width, const DirectLight<D>* earlier = nullptr) {
  const SceneTracer<D> tracer(scene);
  const Index<D> resolution = coarser_resolution<D>(scene.volumes[0].field.dims, width);
  return DirectLight<D>(tracer, 0, split_light(tracer).points, {resolution, true}, ignored,
                        earlier);
}

template <int D>
std::vector<std::uint8_t> codes_of(const DirectLight<D>& direct, std::size_t point) {
  std::vector<std::uint8_t> codes;
  for (std::size_t s = 0; s < direct.lattice().active.size(); ++s) {
    for (const bool back : {false, true}) codes.push_back(direct.code(point, s, back));
  }
  return codes;
}

template <int D>
void expect_earlier_maps_to_serve(int n) {
  Scene<D> scene = test::scene_of(bumps<D>(n), Rgb(0.5f), {0.2, 0.9});
  scene.lights = lights_after<D>(0);
  const DirectLight<D> before = maps_of(scene, 1);
  scene.lights = lights_after<D>(0.2);
  std::swap(scene.lights[0], scene.lights[1]);
  const DirectLight<D> alone = maps_of(scene, 1), after = maps_of(scene, 1, &before);
  ASSERT_EQ(after.points(), before.points());
  for (std::size_t i = 0; i < after.points(); ++i)
    EXPECT_EQ(codes_of(after, i), codes_of(alone, i));
  EXPECT_NE(codes_of(after, 0), codes_of(before, 1));
  const Field<D>& field = scene.volumes[0].field;
  const Vec<D> middle = to_vector<D>(field.dims) * 0.4;
  EXPECT_EQ(after.radiance(field, middle, false), alone.radiance(field, middle, false));
}

TEST(DirectLightOfIsosurfaces, TakesWhatHasNotMovedFromEarlierMaps) {
  expect_earlier_maps_to_serve<3>(21);
  expect_earlier_maps_to_serve<2>(41);
}

TEST(DirectLightOfIsosurfaces, TakesNothingElse) {
  Scene<3> scene = test::scene_of(bumps<3>(21), Rgb(0.5f), {0.2, 0.9});
  scene.lights = lights_after<3>(0);
  const DirectLight<3> alone = maps_of(scene, 1);
  // Compute maps of another scene, in which a plate blocks all light. Reused maps are then wrong.
  Scene<3> other = scene;
  other.lights = lights_after<3>(0.2);
  other.meshes = {test::wall("plate", {-0.05, -1, -1}, {0, 3, 0}, {0, 0, 3}, Rgb(0.5f))};
  const DirectLight<3> wrong = maps_of(other, 1), taken = maps_of(scene, 1, &wrong);
  EXPECT_NE(codes_of(wrong, 0), codes_of(alone, 0));
  EXPECT_EQ(codes_of(taken, 0), codes_of(wrong, 0));
  for (std::size_t i = 1; i < taken.points(); ++i)
    EXPECT_EQ(codes_of(taken, i), codes_of(alone, i));
}

TEST(DirectLightOfIsosurfaces, TakesItFromFinerMaps) {
  Scene<3> scene = test::scene_of(bumps<3>(32), Rgb(0.5f), {0.2, 0.9});
  scene.lights = lights_after<3>(0);
  const DirectLight<3> fine = maps_of(scene, 1), coarse = maps_of(scene, 2, &fine);
  double difference = 0;
  for (std::size_t s = 0; s < coarse.lattice().active.size(); ++s) {
    const Vec3 at = coarse.lattice().center(coarse.lattice().active[s]);
    const std::int32_t slot = nearest_active_slot(fine.lattice(), at);
    ASSERT_NE(slot, TexelLattice<3>::inactive);
    EXPECT_EQ(coarse.code(0, s, false), fine.code(0, slot, false));
    const Vec3 center = fine.lattice().center(fine.lattice().active[slot]);
    difference = std::max(difference, (center - at).length());
  }
  EXPECT_LT(difference, 4);
}

TEST(DirectLightOfIsosurfaces, IsNothingWithoutLights) {
  const Scene<3> scene = test::scene_of(bumps<3>(17), Rgb(0.5f), {0.2, 0.9});
  const SceneTracer<3> tracer(scene);
  const DirectLight<3> direct(tracer, 0, split_light(tracer).points,
                              {scene.volumes[0].field.dims, true}, ignored);
  EXPECT_EQ(direct.points(), 0u);
  EXPECT_EQ(direct.radiance(scene.volumes[0].field, {8, 8, 8}, true), Rgb(0));
}

// Expects the light points of a light to have about its total brightness.
template <class Kind>
void expect_whole(const Kind& light) {
  Scene<3> scene = test::scene_of(bumps<3>(9), Rgb(0.5f), {0.2, 0.9});
  scene.lights.push_back(light);
  const SceneTracer<3> tracer(scene);
  const SplitLight<3> split = split_light(tracer);
  for (const Vec3& at : {Vec3(0.1, -0.2, 0.1), Vec3(-0.3, 0.2, -0.4), Vec3(0, 0, 0.3)}) {
    double from_points = 0, truth = 0;
    const auto add = [&](const LightSource<3>& source, double share, double& sum) {
      const Vec3 direction = source.infinite ? source.direction : at - source.position;
      const double distance = source.infinite ? 1 : direction.length();
      sum += share * average(source.amount) * source.strength(direction.normalized(), distance);
    };
    for (const LightPoint<3>& point : split.points) {
      EXPECT_EQ(point.light, 0);
      add(point.source, 1, from_points);
    }
    Random random(3, 1, 4);
    constexpr int samples = 40'000;
    for (int i = 0; i < samples; ++i) {
      const std::array<double, 2> u{random.uniform(), random.uniform()};
      add(std::visit([&](const auto& l) { return l.source(u); }, tracer.lights()[0]), 1.0 / samples,
          truth);
    }
    EXPECT_NEAR(from_points / truth, 1, 0.03) << light.name;
  }
}

TEST(LightPoints, StandForTheirLight) {
  expect_whole(lamp_above<3>());
  AreaLight<3> disc = lamp_above<3>();
  disc.name = "disc";
  disc.ellipse = true;
  expect_whole(disc);
  PointLight<3> sphere = point_light<3>({0.2, 0.1, 1.6});
  sphere.radius = 0.2;
  expect_whole(sphere);
  PointLight<3> spot = sphere;
  spot.name = "spot";
  spot.cone = PointLight<3>::Cone{Vec3(0, 0, -1), 0.3, 0.2, false};
  expect_whole(spot);
  expect_whole(SunLight<3>{"sun", Vec3(0.3, 0, -1).normalized(), Rgb(2.0f), 0.3});
}

TEST(LightPoints, AreOneWhereALightHasNoExtent) {
  Scene<3> scene = test::scene_of(bumps<3>(9), Rgb(0.5f), {0.2, 0.9});
  scene.lights.push_back(point_light<3>({0, 0, 2}));
  scene.lights.push_back(SunLight<3>{"sun", Vec3(0, 0, -1), Rgb(1)});
  scene.lights.push_back(SunLight<3>{"black sun", Vec3(0, 1, 0), Rgb(0)});
  const SplitLight<3> split = split_light(SceneTracer<3>(scene));
  ASSERT_EQ(split.points.size(), 2u);
  EXPECT_EQ(split.points[0].light, 0);
  EXPECT_EQ(split.points[1].light, 1);
}

TEST(LightPoints, LeaveWideLightToRays) {
  Scene<3> scene = test::scene_of(bumps<3>(9), Rgb(0.5f), {0.2, 0.9});
  Mesh<3> panel = test::wall("panel", {0.4, 0.4, 2}, {0.2, 0, 0}, {0, 0.2, 0}, Rgb(0));
  Mesh<3> sky = test::wall("sky", {-3, -3, 2}, {7, 0, 0}, {0, 7, 0}, Rgb(0));
  panel.emission = sky.emission = Rgb(1);
  scene.meshes = {panel, sky};
  scene.environment = Environment<3>{"world", Rgb(0.5f), nullptr, {}};
  const SplitLight<3> split = split_light(SceneTracer<3>(scene));
  EXPECT_EQ(split.mesh_is_wide, (std::vector<char>{false, true}));
  ASSERT_TRUE(split.wide);
  EXPECT_GE(split.points.size(), 16u);
  for (const LightPoint<3>& point : split.points) EXPECT_EQ(point.light, -1);
}

TEST(LightPoints, TakeTheSunOutOfAnImage) {
  auto image = std::make_shared<Texture>();
  image->width = 64;
  image->height = 32;
  image->pixels.assign(64 * 32, Vec<3, float>(0.1f));
  image->pixels[20 * 64 + 10] = Vec<3, float>(400, 300, 200);
  Scene<3> scene = test::scene_of(bumps<3>(9), Rgb(0.5f), {0.2, 0.9});
  scene.environment = Environment<3>{"world", Rgb(1), image, test::unit_cube<3>(2)};
  const SceneTracer<3> tracer(scene);
  const SplitLight<3> split = split_light(tracer);
  ASSERT_FALSE(split.points.empty());
  ASSERT_TRUE(split.wide && split.wide->image);
  double most = 0, points = 0;
  for (const auto& pixel : split.wide->image->pixels) most = std::max<double>(most, pixel.x);
  EXPECT_LT(most, 10);
  for (const LightPoint<3>& point : split.points) {
    EXPECT_TRUE(point.source.infinite);
    points += average(point.source.amount);
  }
  // Integrate all directions: both parts together must contain all light of the image.
  const double all = EnvironmentSampler<3>(*scene.environment).power(tracer.bounds());
  const double wide = EnvironmentSampler<3>(*split.wide).power(tracer.bounds());
  EXPECT_NEAR(points * tracer.bounds().parallel_area() / (all - wide), 1, 0.1);
}

// Returns true if a wall near an upright edge of the unit cube counts as near a ball within it.
bool wall_is_near(double from_edge, const Vec3* light = nullptr) {
  Scene<3> scene = test::scene_of(test::ball<3>(9), Rgb(0.5f), {0.6, 0.9});
  const Vec3 corner(2 + from_edge, from_edge, -0.5);
  scene.meshes.push_back(test::wall("turned", corner, {-2, 2, 0}, {0, 0, 2}, Rgb(0.5f)));
  const SceneTracer<3> tracer(scene);
  const Vec3 point = light ? tracer.frame().point(*light) : Vec3(0);
  return meshes_near(tracer, 0, light ? &point : nullptr);
}

TEST(MeshesNear, TurnedWallsBesideTheVolumeAreNot) {
  // The box of the wall contains a part of the cube in all cases.
  EXPECT_FALSE(wall_is_near(0.1));
  EXPECT_TRUE(wall_is_near(-0.1));
  const Vec3 inside(0.5, 0.5, 1.6), behind(2, 2, 0.5);
  EXPECT_FALSE(wall_is_near(0.1, &inside));
  EXPECT_TRUE(wall_is_near(0.1, &behind));
}

}  // namespace
}  // namespace leaflight
