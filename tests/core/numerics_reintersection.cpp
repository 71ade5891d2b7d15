// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sampling.h"
#include "figures.h"
#include "trace/scene_tracer.h"

namespace leaflight {
namespace {

struct Place {
  double scale, displacement;  // in sizes of the domain
};
const std::vector<Place> places{{1, 0},   {1e-8, 0},   {1e-4, 0},   {1e4, 0},   {1e8, 0},
                                {1, 1e5}, {1e-8, 1e5}, {1e-4, 1e5}, {1e4, 1e5}, {1e8, 1e5}};

std::string name_of(const Place& place) {
  std::ostringstream text;
  text << "scale " << place.scale << ", displaced by " << place.displacement;
  return text.str();
}

// Returns the transform of a sheared domain of about this scale.
Affine<3> transform(const Place& place, int voxels) {
  Affine<3> m;
  const double step = place.scale / (voxels - 1);
  m.column = {Vec3(1, 0.3, 0) * step, Vec3(-0.2, 0.9, 0.4) * step, Vec3(0.1, 0, -1.1) * step};
  m.origin = Vec3(1, -1, 0.5) * (place.scale * place.displacement);
  return m;
}

Scene<3> placed(const Field<3>& field, const Place& place, const IsovalueRange& isovalue_range) {
  return test::scene_of(
      make_field<3>(field.values, field.dims, transform(place, field.dims[0]), field.owner), Rgb(1),
      isovalue_range);
}

// Returns the field h = i + 2j + 3k, which single precision stores exactly. Its isosurfaces are
// planes.
Field<3> linear() {
  return test::sampled<3>(9,
                          [](const Vec3& x) { return std::round(8 * x.x + 16 * x.y + 24 * x.z); });
}

// Returns a direction away from a plane: cosine-weighted, or within 10^-12 of the plane.
Vec3 departure(const Vec3& normal, Random& random) {
  const Vec3 d = sample_cosine_hemisphere<3>(normal, {random.uniform(), random.uniform()});
  if (random.uniform() < 0.5) return d;
  const Vec3 tangent = (d - normal * d.dot(normal)).normalized();
  return (tangent + normal * std::pow(10, -12 * random.uniform())).normalized();
}

int rays_of(int usual) { return static_cast<int>(test::trials(usual, 10 * usual)); }

TEST(NumericsReintersection, PlaneIsosurfaceIsNotMetAgain) {
  const Field<3> field = linear();
  for (const Place& place : places) {
    const Scene<3> scene = placed(field, place, {1, 47});
    const SceneTracer<3> tracer(scene);
    Random random(97);
    int started = 0, again = 0;
    for (int i = 0; i < rays_of(50'000); ++i) {
      const double c = 10 + 28 * random.uniform();
      const Vec3 direction = test::random_direction(random);
      const Hit<3> hit = tracer.intersect(direction * -3, direction, c);
      if (hit.kind != HitKind::isosurface) continue;
      // Test both sides, as after a reflection and after a refraction.
      const bool above = random.uniform() < 0.5;
      const SurfacePoint<3> from = tracer.isosurface_point(0, hit.isosurface.point, c, above);
      ++started;
      again +=
          tracer.intersect(from, departure(from.geometric_normal, random)).kind != HitKind::none;
    }
    EXPECT_EQ(again, 0) << name_of(place);
    EXPECT_GT(started, rays_of(50'000) / 4);
    test::figure("plane isosurface, " + name_of(place) + ": rays", started);
    test::figure("plane isosurface, " + name_of(place) + ": self-hits", again);
  }
}

// Tests a triangle as wide as the domain, and one a thousand times as wide.
TEST(NumericsReintersection, WallIsNotMetAgain) {
  const Field<3> field = linear();
  for (const Place& place : places) {
    for (const double width : {1.0, 1000.0}) {
      Scene<3> scene = placed(field, place, {1, 47});
      Mesh<3> wall;
      const Affine<3> m = transform(place, 2);
      for (const Vec3& corner :
           {Vec3(-width, 0.3, 0), Vec3(width, -0.2, -width), Vec3(0.1, width, width)}) {
        wall.vertices.emplace_back(m.point(corner));
      }
      wall.facets = {{0, 1, 2}};
      scene.meshes = {wall};
      const SceneTracer<3> tracer(scene);
      Random random(101);
      int again = 0;
      const int rays = rays_of(20'000);
      for (int i = 0; i < rays; ++i) {
        double u = random.uniform(), v = random.uniform();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const SurfacePoint<3> from = tracer.facet_point(0, 0, u, v, i % 2, 20);
        const Hit<3> hit = tracer.intersect(from, departure(from.geometric_normal, random));
        again += hit.kind == HitKind::mesh;
      }
      EXPECT_EQ(again, 0) << name_of(place) << ", width " << width;
      test::figure("wall, " + name_of(place) + ": rays", rays);
      test::figure("wall, " + name_of(place) + ": self-hits", again);
    }
  }
}

// The hit of a ray with the isosurface, and the next hit of a ray from there.
struct Pair {
  Hit<3> first, second;
  double first_cosine = 1, second_cosine = 1;
};

Pair two_hits(const SceneTracer<3>& tracer, Random& random, double c) {
  Pair pair;
  const Vec3 direction = test::random_direction(random), aim = test::random_direction(random);
  const double u = random.uniform(), v = random.uniform();
  pair.first = tracer.intersect(aim * 0.2 - direction * 3, direction, c);
  if (pair.first.kind != HitKind::isosurface) return pair;
  const SurfacePoint<3> from = tracer.surface_point(pair.first, direction, c);
  pair.first_cosine = -from.geometric_normal.dot(direction);
  const Vec3 on = sample_cosine_hemisphere<3>(from.geometric_normal, {u, v});
  pair.second = tracer.intersect(from, on);
  if (pair.second.kind != HitKind::isosurface) return pair;
  pair.second_cosine = -tracer.surface_point(pair.second, on, c).geometric_normal.dot(on);
  return pair;
}

// Hits must be the same at any scale and place. A displacement of 1e5 sizes has a rounding error of
// 2e-11 of the size, divided by the cosine.
TEST(NumericsReintersection, IsTheSameAtAnyScaleAndPlace) {
  const Field<3> field = test::noise<3>(12, 13, -1.0);
  const Scene<3> plain = placed(field, places[0], {0.1, 0.9});
  const SceneTracer<3> plain_tracer(plain);
  for (std::size_t p = 1; p < places.size(); ++p) {
    const Scene<3> scene = placed(field, places[p], {0.1, 0.9});
    const SceneTracer<3> tracer(scene);
    Random random(103), same(103);
    int hits = 0, differences = 0;
    double worst = 0;
    for (int i = 0; i < rays_of(10'000); ++i) {
      const Pair a = two_hits(plain_tracer, random, 0.5), b = two_hits(tracer, same, 0.5);
      if (a.first_cosine < 1e-3 || a.second_cosine < 1e-3) continue;
      if (a.first.kind != b.first.kind || a.second.kind != b.second.kind) {
        ++differences;
        continue;
      }
      if (a.first.kind == HitKind::none) continue;
      ++hits;
      worst =
          std::max(worst, std::abs(a.first.isosurface.t - b.first.isosurface.t) * a.first_cosine);
      if (a.second.kind == HitKind::none) continue;
      worst = std::max(worst, std::abs(a.second.isosurface.t - b.second.isosurface.t) *
                                  a.first_cosine * a.second_cosine);
    }
    EXPECT_EQ(differences, 0) << name_of(places[p]);
    EXPECT_GT(hits, rays_of(10'000) / 2);
    EXPECT_LT(worst, 1e-8) << name_of(places[p]);
    test::figure("noise, " + name_of(places[p]) + ": pairs of hits", hits);
    test::figure("noise, " + name_of(places[p]) + ": other hits", differences);
    test::figure("noise, " + name_of(places[p]) + ": largest change of t", worst);
  }
}

}  // namespace
}  // namespace leaflight
