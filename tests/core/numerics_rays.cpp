// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_ray.h"
#include "fields.h"
#include "figures.h"

namespace leaflight {
namespace {

constexpr int voxels = 9;
// Tolerance of h for ties. Index coordinates are rounded by 1.1e-16 of 3 times the size of the
// domain. h changes by at most its range, 1, along each axis of a cell.
constexpr double tie = 3 * 3 * voxels * 1.2e-16 * 4;

struct Count {
  int rays = 0, hits = 0, missed = 0, invented = 0, ties = 0;
  double worst_residual = 0;

  template <int D>
  void add(const Field<D>& field, const IsosurfaceRay<D>& ray, double tolerance) {
    const test::ExactRay<D> exact(field, ray);
    if (!exact.enters()) return;
    const bool tie_at_entry = test::magnitude(exact.height_at_entry()) < tolerance;
    if (tie_at_entry && !ray.starts_on_isosurface) return;
    const test::ExactCrossing truth = exact.first_crossing(tolerance);
    const auto found = intersect(field, ray);
    ++rays;
    hits += truth.required();
    ties += truth.tie();
    constexpr double slack = 1e-7;
    missed += truth.required() && !(found && found->t <= truth.latest + slack);
    invented += found && !(truth.possible() && found->t >= truth.earliest - slack);
    if (found) worst_residual = std::max(worst_residual, exact.height(found->t));
  }

  void expect_none(const std::string& what, double residual, double most_ties = 0.01) const {
    EXPECT_EQ(missed, 0) << what;
    EXPECT_EQ(invented, 0) << what;
    EXPECT_GT(hits, rays / 10) << what;
    EXPECT_LE(ties, most_ties * rays) << what;
    EXPECT_LE(worst_residual, residual) << what;
    test::figure(what + ": rays", rays);
    test::figure(what + ": hits", hits);
    test::figure(what + ": missed", missed);
    test::figure(what + ": invented", invented);
    test::figure(what + ": ties", ties);
    test::figure(what + ": worst |h - c| / range", worst_residual);
  }
};

int any(Random& random, int count) { return static_cast<int>(random.uniform() * count); }
double sign(Random& random) { return random.uniform() < 0.5 ? -1 : 1; }
double along_axis(Random& random) { return (voxels - 1) * random.uniform(); }

Field<3> values_of(bool integers) {
  Random random(61);
  return test::sampled<3>(
      voxels, [&](const Vec3&) { return integers ? any(random, 4) : random.uniform(); });
}

template <class Ray>
Count count_rays(const Field<3>& field, double isovalue, std::uint64_t seed, int rays,
                 double tolerance, Ray make) {
  Count count;
  Random random(seed);
  for (int i = 0; i < rays; ++i) {
    IsosurfaceRay<3> ray;
    ray.isovalue = isovalue;
    make(random, ray);
    count.add(field, ray, tolerance);
  }
  return count;
}

int rays_of(int usual) { return static_cast<int>(test::trials(usual, 10 * usual)); }

// Aims a ray along an edge of the grid, from outside or inside.
void along_edge(Random& random, IsosurfaceRay<3>& ray) {
  const int axis = any(random, 3);
  for (int a = 0; a < 3; ++a) ray.position[a] = any(random, voxels);
  ray.position[axis] = 3 * along_axis(random) - (voxels - 1);
  ray.direction = Vec3(0.0);
  ray.direction[axis] = sign(random);
}

// Aims a ray along a face of the grid.
void in_face(Random& random, IsosurfaceRay<3>& ray) {
  const int axis = any(random, 3);
  for (int a = 0; a < 3; ++a) {
    ray.position[a] = 3 * along_axis(random) - (voxels - 1);
    ray.direction[a] = along_axis(random) - ray.position[a];
  }
  ray.position[axis] = 1 + any(random, voxels - 2);  // inside the domain
  ray.direction[axis] = 0;
}

// Aims a ray from a grid point at a voxel, so that it passes exactly through corners.
void through_corners(Random& random, IsosurfaceRay<3>& ray) {
  do {
    for (int a = 0; a < 3; ++a) {
      ray.position[a] = any(random, 3 * voxels) - voxels;
      ray.direction[a] = any(random, voxels) - ray.position[a];
    }
  } while (!(ray.direction.length2() > 0));
}

// Aims a ray from anywhere at a point of an edge, which it hits up to rounding.
void towards_edge(Random& random, IsosurfaceRay<3>& ray) {
  Vec3 target;
  for (int a = 0; a < 3; ++a) {
    ray.position[a] = 3 * along_axis(random) - (voxels - 1);
    target[a] = any(random, voxels);
  }
  target[any(random, 3)] = along_axis(random);
  ray.direction = target - ray.position;
}

TEST(NumericsRays, AlongEdgesFacesAndThroughCorners) {
  const Field<3> field = values_of(false);
  const int rays = rays_of(20'000);
  count_rays(field, 0.5, 1, rays, tie, along_edge).expect_none("along edges", tie);
  count_rays(field, 0.5, 2, rays, tie, in_face).expect_none("in faces", tie);
  count_rays(field, 0.5, 3, rays, tie, through_corners).expect_none("through corners", tie);
  count_rays(field, 0.5, 4, rays, tie, towards_edge).expect_none("towards edges", tie);
}

// Test 8-bit data at one of their values. Along edges between voxels, from integer positions, every
// step is exact, so ties must follow the rule: equal is above.
TEST(NumericsRays, TiesFollowTheRuleOnEdges) {
  const Field<3> field = values_of(true);
  const Count count =
      count_rays(field, 2, 5, rays_of(20'000), 0, [](Random& random, IsosurfaceRay<3>& ray) {
        along_edge(random, ray);
        for (int a = 0; a < 3; ++a) ray.position[a] = std::round(ray.position[a]);
      });
  count.expect_none("exact ties on edges", 3 * tie);
}

TEST(NumericsRays, IntegersAtAnIntegerIsovalue) {
  const Field<3> field = values_of(true);
  const int rays = rays_of(20'000);
  constexpr double range = 3;
  const double most = range * tie;
  count_rays(field, 2, 6, rays, most, in_face).expect_none("integers, in faces", most, 0.5);
  count_rays(field, 2, 7, rays, most, through_corners)
      .expect_none("integers, through corners", most, 0.5);
  count_rays(field, 2, 8, rays, most, towards_edge)
      .expect_none("integers, towards edges", most, 0.5);
}

// A component too small to move the ray must change nothing.
TEST(NumericsRays, ZeroAndDenormalComponents) {
  const Field<3> field = values_of(false);
  Random random(67);
  const int rays = rays_of(2000);
  int hits = 0;
  double worst = 0;
  for (int i = 0; i < rays; ++i) {
    IsosurfaceRay<3> ray;
    ray.isovalue = 0.5;
    in_face(random, ray);
    if (i % 2) {
      const int axis = any(random, 3);
      for (int a = 0; a < 3; ++a) {
        ray.position[a] = a == axis ? -2 : along_axis(random);
        ray.direction[a] = a == axis;
      }
    }
    const auto plain = intersect(field, ray);
    hits += plain.has_value();
    for (const double tiny : {5e-324, -5e-324, 1e-310, -1e-310, 2.3e-308, 1e-200, -1e-100, 1e-30}) {
      IsosurfaceRay<3> bent = ray;
      for (int a = 0; a < 3; ++a) {
        if (ray.direction[a] == 0) bent.direction[a] = tiny;
      }
      const auto found = intersect(field, bent);
      ASSERT_EQ(found.has_value(), plain.has_value()) << "ray " << i << ", " << tiny;
      if (found) worst = std::max(worst, std::abs(found->t - plain->t));
    }
  }
  EXPECT_GT(hits, rays / 10);
  EXPECT_LT(worst, 1e-12);
  test::figure("denormal components: largest change of t", worst);
}

// Test -0.0, and directions of very small and very large length.
TEST(NumericsRays, LengthOfTheDirection) {
  const Field<3> field = values_of(false);
  Random random(71);
  double worst = 0;
  for (int i = 0; i < rays_of(2000); ++i) {
    IsosurfaceRay<3> ray;
    ray.isovalue = 0.5;
    i % 2 ? in_face(random, ray) : towards_edge(random, ray);
    const auto plain = intersect(field, ray);
    for (const double length : {1e-100, 1e-20, 1e20, 1e100}) {
      IsosurfaceRay<3> scaled = ray;
      scaled.direction *= length;
      for (int a = 0; a < 3; ++a) {
        if (ray.direction[a] == 0) scaled.direction[a] = -0.0;
      }
      const auto found = intersect(field, scaled);
      ASSERT_EQ(found.has_value(), plain.has_value()) << "ray " << i << ", " << length;
      if (found) worst = std::max(worst, std::abs(found->t * length - plain->t));
    }
  }
  EXPECT_LT(worst, 1e-9);
  test::figure("length of the direction: largest change of t", worst);
}

// The place where a ray starts on the isosurface: inside cells, on their faces or on their edges. A
// hit must never be the start.
enum class Start { cell, face, edge };

IsosurfaceRay<3> start_on_isosurface(const Field<3>& field, Random& random, Start start) {
  for (;;) {
    IsosurfaceRay<3> ray;
    ray.isovalue = 0.5;
    if (start == Start::cell) towards_edge(random, ray);
    if (start == Start::face) in_face(random, ray);
    if (start == Start::edge) along_edge(random, ray);
    const auto hit = intersect(field, ray);
    if (!hit) continue;
    ray.starts_on_isosurface = true;
    ray.origin = hit->point;
    ray.position = hit->point.index_position();
    ray.direction = test::random_direction(random);
    if (random.uniform() < 0.3) ray.direction[any(random, 3)] = 0;
    ray.starts_above = test::ExactRay<3>(field, ray).rises();
    return ray;
  }
}

TEST(NumericsRays, StartingOnTheIsosurface) {
  const Field<3> field = values_of(false);
  for (const auto& [start, name] :
       {std::pair{Start::cell, "within cells"}, std::pair{Start::face, "on faces"},
        std::pair{Start::edge, "on edges"}}) {
    Random random(73);
    Count count;
    for (int i = 0; i < rays_of(20'000); ++i) {
      count.add(field, start_on_isosurface(field, random, start), tie);
    }
    count.expect_none(std::string("starting on the isosurface ") + name, tie);
  }
}

}  // namespace
}  // namespace leaflight
