// SPDX-License-Identifier: GPL-3.0-or-later
// Tests every sampler against its density: chi-square over bins, with the density integrated over
// each bin. The densities are derived here independently, from the geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <type_traits>

#include "agreement.h"
#include "bake/texels/texel_samples.h"
#include "scenes.h"
#include "statistics.h"
#include "transport/light_sampler.h"

namespace leaflight {
namespace {

using test::Histogram;
using U = std::array<double, 2>;

constexpr int draws = test::sanitized ? 20'000 : 100'000;

U pair(Random& random) {
  const double u = random.uniform();
  return {u, random.uniform()};
}

// Returns the azimuth of v about n, in [0,1).
double turn(const Vec3& v, const Vec3& n) {
  const auto [t, b] = tangents(n);
  const double phi = std::atan2(v.dot(b), v.dot(t)) / (2 * pi);
  return phi < 0 ? phi + 1 : phi;
}

// Maps directions within an angle of an axis to the unit cube, so that uniform directions become
// uniform points. The angle is given by 1 - its cosine.
template <int D>
struct Cap {
  Vec<D> axis;
  double one_minus_cosine = 2;

  std::vector<double> coordinates(const Vec<D>& direction) const {
    if constexpr (D == 2) {
      return {std::atan2(direction.dot(tangents(axis)[0]), direction.dot(axis)) / measure() + 0.5};
    } else {
      // Compute 1 - cosine without cancellation.
      return {0.5 * (direction - axis).length2() / one_minus_cosine, turn(direction, axis)};
    }
  }
  Vec<D> direction(const std::vector<double>& u) const {
    if constexpr (D == 2) {
      const double angle = (u[0] - 0.5) * measure();
      return axis * std::cos(angle) + tangents(axis)[0] * std::sin(angle);
    } else {
      const double theta = std::acos(1 - u[0] * one_minus_cosine), phi = 2 * pi * u[1];
      const auto [t, b] = tangents(axis);
      return axis * std::cos(theta) + (t * std::cos(phi) + b * std::sin(phi)) * std::sin(theta);
    }
  }
  double measure() const {
    const double angle = std::acos(1 - one_minus_cosine);
    return D == 2 ? 2 * angle : 2 * pi * one_minus_cosine;
  }
};

// Returns coordinates of a direction about a normal that are uniform for the cosine-weighted
// density: (sin^2, azimuth), or the sine in the plane (Nusselt's analog).
template <int D>
std::vector<double> cosine_coordinates(const Vec<D>& direction, const Vec<D>& normal) {
  if constexpr (D == 2) {
    return {(direction.dot(tangents(normal)[0]) + 1) / 2};
  } else {
    const double cosine = direction.dot(normal);
    return {1 - cosine * cosine, turn(direction, normal)};
  }
}

// Returns coordinates of a point of the unit disk perpendicular to n: (r^2, azimuth), or the place
// on a segment in the plane.
template <int D>
std::vector<double> disc_coordinates(const Vec<D>& beside, const Vec<D>& n) {
  if constexpr (D == 2) {
    return {(beside.dot(tangents(n)[0]) + 1) / 2};
  } else {
    return {beside.length2(), turn(beside, n)};
  }
}

std::vector<double> joined(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Returns the number of bins along each of n axes, the same for all: some hundreds of bins in 3 or
// 4 dimensions.
std::vector<int> bins(int n) { return std::vector<int>(n, n == 4 ? 4 : n == 3 ? 6 : 12); }

// Returns a direction that is tilted against all axes.
template <int D>
Vec<D> tilted() {
  if constexpr (D == 2) {
    return Vec<2>(0.6, -0.8);
  } else {
    return Vec3(-0.3, 0.5, -0.8).normalized();
  }
}

template <int D>
AreaLight<D> area_light() {
  if constexpr (D == 2) {
    return {"lamp", {0.2, -0.5}, {Vec<2>(0.7, 0.1)}, Rgb(2)};
  } else {
    return {"lamp", {0.2, 0.1, -0.5}, {Vec3(0.7, 0, 0.1), Vec3(0, 0.4, 0)}, Rgb(2)};
  }
}

// Returns a point in front of a light, beside its center.
template <int D>
Vec<D> lit_by(const AreaLight<D>& light) {
  return light.point({0.3, 0.8}) + light.normal() * 0.4;
}

template <class Body>
void in_plane_and_space(Body body) {
  {
    SCOPED_TRACE("plane");
    body(std::integral_constant<int, 2>());
  }
  SCOPED_TRACE("space");
  body(std::integral_constant<int, 3>());
}

TEST(Samplers, CosineHemisphere) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    Random random(1);
    const Vec<D> n = tilted<D>();
    Histogram histogram(bins(D - 1));
    for (int i = 0; i < draws; ++i) {
      const Vec<D> direction = sample_cosine_hemisphere<D>(n, pair(random));
      ASSERT_NEAR(direction.length(), 1, 1e-12);
      ASSERT_GE(direction.dot(n), 0);
      histogram.add(cosine_coordinates<D>(direction, n));
    }
    EXPECT_TRUE(histogram.uniform());
  });
}

TEST(Samplers, ConeAndDisc) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    for (const double width : {1e-6, 0.1, 1.3, 2.0}) {
      SCOPED_TRACE(width);
      Random random(2);
      const Cap<D> cap{tilted<D>(), width};
      EXPECT_NEAR(cone_measure<D>(width) / cap.measure(), 1, 1e-6);
      Histogram cone(bins(D - 1)), disc(bins(D - 1));
      for (int i = 0; i < draws; ++i) {
        cone.add(cap.coordinates(sample_cone<D>(cap.axis, width, pair(random))));
        disc.add(disc_coordinates<D>(sample_facing_disc<D>(cap.axis, pair(random)), cap.axis));
      }
      EXPECT_TRUE(cone.uniform());
      EXPECT_TRUE(disc.uniform());
    }
  });
}

// Tests any point of the sequence over its seeds, with the third dimension that texels add.
TEST(Samplers, SobolPointIsUniformOverItsSeeds) {
  for (const std::uint32_t index : {0u, 1u, 31u, 1000u}) {
    SCOPED_TRACE(index);
    Random keys(3);
    Histogram histogram(bins(3));
    for (int i = 0; i < draws; ++i) {
      const std::uint64_t key = keys.bits();
      const U xy = sobol_point(index, key);
      histogram.add({xy[0], xy[1], sobol_point(index, ~key)[0]});
    }
    EXPECT_TRUE(histogram.uniform());
  }
}

TEST(Samplers, DiscreteDistribution) {
  Random random(4);
  const std::vector<double> weights{3, 0, 1, 0, 0, 0.01, 7};
  const DiscreteDistribution distribution(weights);
  constexpr int parts = 6;
  std::vector<double> counts(parts * weights.size(), 0), expected;
  for (const double w : weights) {
    for (int i = 0; i < parts; ++i) expected.push_back(w / 11.01 * draws / parts);
  }
  for (int i = 0; i < draws; ++i) {
    const auto pick = distribution.pick(random.uniform());
    ASSERT_NEAR(pick.probability, weights[pick.index] / 11.01, 1e-12);
    ++counts[parts * pick.index + static_cast<std::size_t>(pick.rest * parts)];
  }
  EXPECT_TRUE(test::agree(counts, expected));
}

// Compares directions of shadow rays with `density` per angle, in a cap that contains them all. A
// sample's radiance must be the light's radiance over the density.
template <int D, class Sample, class Density, class Radiance>
void expect_light_samples(const Cap<D>& cap, Sample sample, Density density, Radiance radiance) {
  Random random(5);
  Histogram histogram(bins(D - 1));
  for (int i = 0; i < draws; ++i) {
    const LightSample<D> s = sample(random);
    ASSERT_NEAR(s.direction.length(), 1, 1e-12);
    histogram.add(cap.coordinates(s.direction));
    const double expected = radiance(s.direction);
    // Rounding may put rays along the very rim on either side of it.
    if (density(s.direction) > 0) {
      ASSERT_NEAR(s.radiance.x * density(s.direction), expected, 1e-4 * expected);
    }
  }
  EXPECT_TRUE(histogram.against(
      [&](const std::vector<double>& u) { return density(cap.direction(u)) * cap.measure(); },
      D == 2 ? 10'000 : 48));
}

// Returns the density per angle of uniform points on the light, given a ray that hits its plane.
template <int D>
double area_density(const AreaLight<D>& light, const Vec<D>& from, const Vec<D>& direction) {
  const Vec<D> normal = light.normal();
  const double cosine = -direction.dot(normal);
  const double t = (from - light.corner).dot(normal) / cosine;
  if (!(cosine > 0 && t > 0)) return 0;
  const Vec<D> at = from + direction * t - light.corner;
  double radius2 = 0;
  for (const Vec<D>& edge : light.edges) {
    const double x = 2 * at.dot(edge) / edge.dot(edge) - 1;
    if (std::abs(x) > 1) return 0;
    radius2 += x * x;
  }
  if (light.ellipse && radius2 > 1) return 0;
  return std::pow(t, D - 1) / (cosine * light.area());
}

template <int D>
void expect_area_light(const AreaLight<D>& light) {
  const Vec<D> from = lit_by(light);
  expect_light_samples<D>(
      {-light.normal(), 1}, [&](Random& random) { return light.sample(from, pair(random)); },
      [&](const Vec<D>& w) { return area_density(light, from, w); },
      [&](const Vec<D>&) { return light.radiance.x; });
}

TEST(Samplers, AreaLights) {
  in_plane_and_space([](auto d) { expect_area_light(area_light<d>()); });
  AreaLight<3> ellipse = area_light<3>();
  ellipse.edges = {Vec3(0.7, 0, 0), Vec3(0, 0.4, 0)};
  ellipse.ellipse = true;
  expect_area_light(ellipse);
}

TEST(Samplers, SphereLights) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    for (const double distance : {0.31, 2.0}) {
      SCOPED_TRACE(distance);
      const PointLight<D> light{"bulb", Vec<D>(0.1), 0.3, Rgb(3), {}};
      const Vec<D> axis = tilted<D>(), from = light.position - axis * distance;
      const double cosine = std::sqrt(1 - std::pow(light.radius / distance, 2));
      const double measure = Cap<D>{axis, 1 - cosine}.measure();
      expect_light_samples<D>(
          {axis, 1.2 * (1 - cosine)},
          [&](Random& random) { return light.sample(from, pair(random)); },
          [&](const Vec<D>& w) { return w.dot(axis) > cosine ? 1 / measure : 0; },
          // From far away, its disk or segment has the given intensity.
          [&](const Vec<D>&) { return 3 / (D == 3 ? pi * 0.09 : 0.6); });
    }
  });
}

TEST(Samplers, Suns) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const SunLight<D> light{"sun", tilted<D>(), Rgb(3), 0.8};
    const double width = 1 - std::cos(0.4), sine = std::sin(0.4);
    const double measure = Cap<D>{light.direction, width}.measure();
    expect_light_samples<D>(
        {-light.direction, 1.2 * width},
        [&](Random& random) { return light.sample(Vec<D>(0.0), pair(random)); },
        [&](const Vec<D>& w) { return -w.dot(light.direction) > 1 - width ? 1 / measure : 0; },
        [&](const Vec<D>&) { return 3 / (D == 3 ? pi * sine * sine : 2 * sine); });
  });
}

// Returns a rectangle in triangles, or a segment in segments, of different sizes.
template <int D>
Mesh<D> uneven_mesh(const AreaLight<D>& like) {
  Mesh<D> mesh;
  std::vector<Vec<D>> points;
  if constexpr (D == 2) {
    for (const double u : {0.0, 0.1, 0.6, 1.0}) points.push_back(like.point({u, 0}));
    mesh.facets = {{0, 1}, {1, 2}, {2, 3}};
  } else {
    for (const U& u : {U{0, 0}, U{1, 0}, U{1, 1}, U{0, 1}, U{0.2, 0.3}}) {
      points.push_back(like.point(u));
    }
    mesh.facets = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  }
  for (const Vec<D>& p : points) mesh.vertices.emplace_back(p);
  mesh.emission = like.radiance;
  return mesh;
}

TEST(Samplers, MeshEmitters) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const AreaLight<D> light = area_light<D>();
    const Mesh<D> mesh = uneven_mesh(light);
    const MeshEmitter<D> emitter(mesh);
    const Vec<D> from = lit_by(light);
    expect_light_samples<D>(
        {-light.normal(), 1},
        [&](Random& random) {
          const double choice = random.uniform();
          return emitter.sample(from, choice, pair(random));
        },
        [&](const Vec<D>& w) { return area_density(light, from, w); },
        [&](const Vec<D>&) { return light.radiance.x; });
  });
}

// Returns an image with dark and bright pixels. The brightest are at a pole and at the border,
// where the image wraps around.
std::shared_ptr<const Texture> sky_image() {
  auto image = std::make_shared<Texture>();
  image->width = 16;
  image->height = 8;
  Random random(6);
  for (int p = 0; p < image->width * image->height; ++p) {
    const double dark = random.uniform() < 0.5 ? 0.01 : 1;
    image->pixels.emplace_back(static_cast<float>(dark * random.uniform()));
  }
  image->pixels[3 * 16] = Vec<3, float>(8);
  image->pixels[7 * 16 + 5] = Vec<3, float>(4);
  return image;
}

// The density per angle of the sampled image. It is proportional to the sum over a pixel and its
// neighbors, times the cosine of the row's center.
class SkyDensity {
 public:
  explicit SkyDensity(const Texture& image) : width_(image.width), height_(image.height) {
    for (int j = 0; j < height_; ++j) {
      for (int i = 0; i < width_; ++i) {
        double sum = 0;
        for (int y = j + height_ - 1; y <= j + height_ + 1; ++y) {
          for (int x = i + width_ - 1; x <= i + width_ + 1; ++x) {
            sum += image.pixels[y % height_ * width_ + x % width_].x;
          }
        }
        weights_.push_back(sum * std::sin((j + 0.5) / height_ * pi));
        total_ += weights_.back();
      }
    }
  }
  double operator()(const Vec3& w) const {
    const double u = 0.5 - std::atan2(w.y, w.x) / (2 * pi);
    const double v = std::acos(std::clamp(-w.z, -1.0, 1.0)) / pi;
    const int i = std::clamp(static_cast<int>(u * width_), 0, width_ - 1);
    const int j = std::clamp(static_cast<int>(v * height_), 0, height_ - 1);
    return weights_[j * width_ + i] / total_ * width_ * height_ / (2 * pi * pi * std::sin(v * pi));
  }

 private:
  int width_, height_;
  std::vector<double> weights_;
  double total_ = 0;
};

Environment<3> sky() {
  Environment<3> environment{"sky", Rgb(2), sky_image(), {}};
  environment.world_to_image = test::unit_cube<3>(2);
  return environment;
}

TEST(Samplers, Environments) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const Environment<D> constant{"sky", Rgb(2), nullptr, {}};
    const EnvironmentSampler<D> sampler(constant);
    const Vec<D> n = tilted<D>();
    expect_light_samples<D>(
        {n, 1}, [&](Random& random) { return sampler.sample(n, pair(random)); },
        [&](const Vec<D>& w) { return std::max(0.0, w.dot(n)) / (D == 3 ? pi : 2); },
        [&](const Vec<D>&) { return 2; });
  });
  const Environment<3> environment = sky();
  const EnvironmentSampler<3> sampler(environment);
  const SkyDensity density(*environment.image);
  const Vec3 n = tilted<3>();
  expect_light_samples<3>(
      {{0, 0, 1}, 2}, [&](Random& random) { return sampler.sample(n, pair(random)); },
      [&](const Vec3& w) { return 0.5 * (std::max(0.0, w.dot(n)) / pi + density(w)); },
      [&](const Vec3& w) { return sampler.radiance(w).x; });
}

// Tests the joint distribution of positions and directions of photons, so that dependence would
// show.
template <int D, class Emit, class Place, class Direction>
void expect_emission(Emit emit, Place place, Direction direction) {
  Random random(7);
  Histogram histogram(bins(2 * (D - 1)));
  for (int i = 0; i < draws; ++i) {
    const U position = pair(random);
    const EmittedPhoton<D> photon = emit(position, pair(random), random);
    ASSERT_NEAR(photon.direction.length(), 1, 1e-12);
    histogram.add(joined(place(photon), direction(photon)));
  }
  EXPECT_TRUE(histogram.uniform());
}

template <int D>
std::vector<double> on_light(const AreaLight<D>& light, const Vec<D>& position) {
  std::vector<double> u;
  const Vec<D> at = position - light.corner;
  for (const Vec<D>& edge : light.edges) u.push_back(at.dot(edge) / edge.dot(edge));
  return u;
}

TEST(Emission, AreaLightsAndMeshes) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const AreaLight<D> light = area_light<D>();
    const BoundingSphere<D> nowhere;
    const auto place = [&](const auto& photon) { return on_light(light, photon.origin); };
    expect_emission<D>(
        [&](const U& u, const U& v, Random&) { return light.emit(nowhere, u, v); }, place,
        [&](const auto& p) { return cosine_coordinates<D>(p.direction, light.normal()); });
    const Mesh<D> mesh = uneven_mesh(light);
    const MeshEmitter<D> emitter(mesh);
    int front = 0;
    expect_emission<D>([&](const U& u, const U& v,
                           Random& random) { return emitter.emit(random.uniform(), u, v); },
                       place,
                       [&](const auto& p) {
                         const bool forward = p.direction.dot(light.normal()) > 0;
                         front += forward;
                         return cosine_coordinates<D>(p.direction,
                                                      light.normal() * (forward ? 1.0 : -1.0));
                       });
    EXPECT_LT(std::abs(front - draws / 2), test::z_limit() * std::sqrt(draws / 4.0));
  });
  AreaLight<3> ellipse{"disc", {0, 0, 0}, {Vec3(2, 0, 0), Vec3(0, 2, 0)}, Rgb(1), true};
  expect_emission<3>(
      [&](const U& u, const U& v, Random&) { return ellipse.emit({}, u, v); },
      [](const auto& p) {
        return disc_coordinates<3>(Vec3(p.origin.x - 1, p.origin.y - 1, 0), {0, 0, 1});
      },
      [&](const auto& p) { return cosine_coordinates<3>(p.direction, ellipse.normal()); });
}

TEST(Emission, SpheresAndSpots) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    PointLight<D> light{"bulb", Vec<D>(0.1), 0.3, Rgb(3), {}};
    for (const double width : {2.0, 0.3}) {
      SCOPED_TRACE(width);
      const Cap<D> cap{tilted<D>(), width};
      if (width < 2) light.cone = typename PointLight<D>::Cone{cap.axis, 1 - width, 0.5, true};
      expect_emission<D>([&](const U& u, const U& v, Random&) { return light.emit({}, u, v); },
                         [&](const auto& p) {
                           const Vec<D> at = (p.origin - light.position) / light.radius;
                           EXPECT_NEAR(at.length(), 1, 1e-9);
                           EXPECT_GT(at.dot(p.direction), -1e-9);
                           return disc_coordinates<D>(at - p.direction * at.dot(p.direction),
                                                      p.direction);
                         },
                         [&](const auto& p) { return cap.coordinates(p.direction); });
    }
  });
}

// Parallel light starts on a disk outside the bounds.
template <int D>
std::vector<double> before(const BoundingSphere<D>& bounds, const EmittedPhoton<D>& photon) {
  const Vec<D> beside = (photon.origin - bounds.center) / bounds.radius + photon.direction;
  EXPECT_NEAR(beside.dot(photon.direction), 0, 1e-9);
  return disc_coordinates<D>(beside, photon.direction);
}

TEST(Emission, SunsAndEnvironments) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const BoundingSphere<D> bounds{Vec<D>(0.3), 1.7};
    const SunLight<D> sun{"sun", tilted<D>(), Rgb(3), 0.8};
    const Cap<D> disc{sun.direction, 1 - std::cos(0.4)};
    expect_emission<D>([&](const U& u, const U& v, Random&) { return sun.emit(bounds, u, v); },
                       [&](const auto& p) { return before(bounds, p); },
                       [&](const auto& p) { return disc.coordinates(p.direction); });
    const Environment<D> constant{"sky", Rgb(2), nullptr, {}};
    const EnvironmentSampler<D> sampler(constant);
    const Cap<D> all{tilted<D>()};
    expect_emission<D>([&](const U& u, const U& v, Random&) { return sampler.emit(bounds, u, v); },
                       [&](const auto& p) { return before(bounds, p); },
                       [&](const auto& p) { return all.coordinates(p.direction); });
  });
  const Environment<3> environment = sky();
  const EnvironmentSampler<3> sampler(environment);
  const SkyDensity density(*environment.image);
  const BoundingSphere<3> bounds{Vec3(0.3), 1.7};
  Random random(8);
  const Cap<3> all{{0, 0, 1}, 2};
  Histogram histogram(bins(2));
  for (int i = 0; i < draws; ++i) {
    const U u = pair(random);
    const EmittedPhoton<3> photon = sampler.emit(bounds, u, pair(random));
    const Vec3 from = -photon.direction;
    histogram.add(all.coordinates(from));
    ASSERT_NEAR(photon.flux.x * density(from) / (pi * 1.7 * 1.7 * sampler.radiance(from).x), 1,
                1e-3);
  }
  EXPECT_TRUE(histogram.against(
      [&](const std::vector<double>& u) { return density(all.direction(u)) * all.measure(); }, 48));
}

// Samples of emissive isosurfaces: 1 / density must integrate to the volume of each part of the
// field, equally for both sides.
TEST(Emission, Isosurfaces) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    // 19 nodes make bricks of different sizes. The gradient is not constant.
    Scene<D> scene = test::scene_of(
        test::sampled<D>(19, [](const Vec<D>& x) { return x[0] + x[0] * x[0] + 0.3 * x[1]; }),
        Rgb(0.5f), {-1, 3});
    scene.volumes[0].emission = ColorRamp({{0, Rgb(0.1f)}, {2.3, Rgb(2)}});
    const SceneTracer<D> tracer(scene);
    const IsosurfaceEmitter<D> emitter(tracer, 0);
    constexpr int parts = 5, count = D == 2 ? 25 : 125;
    std::vector<double> sum(count, 0), sum2(count, 0);
    Random random(9);
    int backs = 0;
    for (int i = 0; i < draws; ++i) {
      const auto sample = emitter.sample(random.uniform(), random);
      ASSERT_EQ(sample.point.kind(), HitKind::isosurface);
      backs += sample.point.isosurface().back;
      int part = 0;
      for (int a = 0; a < D; ++a) {
        part = parts * part +
               std::min(parts - 1, static_cast<int>((sample.point.position[a] + 0.5) * parts));
      }
      const double angle = D == 3 ? pi : 2;
      const double steepness =
          sample.point.isosurface().gradient_length / scene.isovalue_range.height();
      const double volume =
          sample.flux_height.x / (2 * angle * sample.point.emission.x * steepness);
      sum[part] += volume;
      sum2[part] += volume * volume;
    }
    EXPECT_LT(std::abs(backs - draws / 2), test::z_limit() * std::sqrt(draws / 4.0));
    for (int part = 0; part < count; ++part) {
      const double mean = sum[part] / draws;
      const double error = std::sqrt((sum2[part] / draws - mean * mean) / draws);
      EXPECT_NEAR(mean, 1.0 / count, test::z_limit(count) * error) << part;
    }
  });
}

// Photons start on lights in proportion to their power.
TEST(Emission, ChoosesByPower) {
  Scene<3> scene = test::scene_of(test::ball<3>(9), Rgb(0.5f), {0.3, 0.9});
  const Vec3 down(0, 0, -1);
  scene.lights = {area_light<3>(), PointLight<3>{"bulb", {0.5, 0.5, 1.5}, 0, Rgb(0.1f), {}},
                  SunLight<3>{"sun", down, Rgb(0.3f), 0}};
  scene.meshes = {test::wall("glow", {0.2, 0.2, 1.3}, {0, 0.5, 0}, {0.7, 0, 0}, Rgb(0))};
  scene.meshes[0].emission = Rgb(1);
  scene.environment = Environment<3>{"sky", Rgb(0.1f), nullptr, {}};
  const SceneTracer<3> tracer(scene);
  const LightSampler<3> lights(tracer);
  const double disc = pi * std::pow(tracer.bounds().radius, 2);
  std::vector<double> expected{pi * area_light<3>().area() * 2, 4 * pi * 0.1, disc * 0.3,
                               2 * pi * 0.35, 4 * pi * disc * 0.1};
  double total = 0;
  for (const double power : expected) total += power;
  for (double& power : expected) power *= draws / total;
  std::vector<double> counts(expected.size(), 0);
  Random random(10);
  const Vec3 bulb = tracer.frame().point({0.5, 0.5, 1.5});
  for (int i = 0; i < draws; ++i) {
    const double choice = random.uniform();
    const U position = pair(random);
    const auto start = lights.emit(0.5, choice, position, pair(random), random);
    const Vec3 world = start.from.position / tracer.frame().scale + tracer.frame().center;
    const AreaLight<3> lamp = area_light<3>();
    int light = 4;
    if ((start.from.position - bulb).length() < 1e-6) {
      light = 1;
    } else if (start.direction.dot(down) > 1 - 1e-12) {
      light = 2;
    } else if (std::abs(world.z - 1.3) < 1e-4 && world.x >= 0.2 && world.x <= 0.9) {
      light = 3;
    } else if (std::abs((world - lamp.corner).dot(lamp.normal())) < 1e-4) {
      light = 0;
    }
    ++counts[light];
  }
  EXPECT_TRUE(test::agree(counts, expected));
}

// The estimate of a shadow ray must be the light's radiance over the probability of its choice.
// Lights without extent give distinct estimates at the point, which identify the chosen light.
TEST(Samplers, LightChoiceHasTheProbabilityItDividesBy) {
  Scene<3> scene =
      test::scene_of(test::sampled<3>(9, [](const Vec3& x) { return x.z; }), Rgb(1), {0.2, 0.8});
  const std::vector<Vec3> places{{0.1, 0.2, -0.5}, {0.9, 0.1, -0.2}, {0.4, 0.9, -3}, {2, 2, -0.1}};
  for (const Vec3& place : places) scene.lights.push_back(PointLight<3>{"", place, 0, Rgb(1), {}});
  scene.lights.push_back(SunLight<3>{"sun", {0, 0, 1}, Rgb(0.2f), 0});
  const SceneTracer<3> tracer(scene);
  const LightSampler<3> lights(tracer);
  const CellPoint<3> at = locate(test::field_of(scene), Vec3(4.2, 4.7, 4.0));
  const SurfacePoint<3> point = tracer.isosurface_point(0, at, 0.5, false);
  std::vector<double> alone;  // contribution of each light alone
  for (const Vec3& place : places) {
    const Vec3 to_point = tracer.frame().point(place) - point.position;
    alone.push_back(to_point.normalized().dot(point.shading_normal) / to_point.length2() / pi);
  }
  alone.push_back(0.2 / pi);
  Random random(11);
  std::uint64_t rays = 0;
  std::map<float, double> found;
  for (int i = 0; i < draws; ++i) {
    const double choice = random.uniform();
    ++found[static_cast<float>(lights.direct_radiance(point, choice, pair(random), rays).x)];
  }
  ASSERT_EQ(found.size(), alone.size());
  // The choice selects lights in their order, so increasing choices identify them.
  std::vector<double> counts, expected;
  std::set<float> seen;
  for (int i = 0; i < draws && seen.size() < alone.size(); ++i) {
    const float value =
        static_cast<float>(lights.direct_radiance(point, (i + 0.5) / draws, {0.5, 0.5}, rays).x);
    if (!seen.insert(value).second) continue;
    expected.push_back(alone[counts.size()] / value * draws);
    counts.push_back(found[value]);
  }
  double sum = 0;
  for (const double e : expected) sum += e;
  EXPECT_NEAR(sum / draws, 1, 1e-4);
  EXPECT_TRUE(test::agree(counts, expected));
}

// Points of a texel must be uniform over its box of +-0.35 texels, clipped to the domain. The test
// uses one point of the sequence over many scrambles, which are keys of texels.
TEST(Samplers, PointsOfATexel) {
  in_plane_and_space([](auto d) {
    constexpr int D = d;
    const Scene<D> scene = test::scene_of(
        test::sampled<D>(9, [](const Vec<D>& x) { return x[D - 1]; }), Rgb(1), {-1, 2});
    const SceneTracer<D> tracer(scene);
    Index<D> resolution;
    resolution.fill(5);
    const TexelLattice<D> lattice = make_lattice(test::field_of(scene), resolution, -1, 2);
    for (const int along : {0, 2, 4}) {
      SCOPED_TRACE(along);
      Index<D> texel;
      texel.fill(2);
      texel[0] = along;
      Random random(12);
      Histogram histogram(bins(D));
      for (int i = 0; i < draws / 2; ++i) {
        const int number = static_cast<int>(random.uniform() * 8);
        for_each_texel_sample(tracer, 0, false, lattice,
                              static_cast<std::uint32_t>(lattice.linear(texel)), number + 1,
                              random.bits(), [&](const SurfacePoint<D>& point, int n) {
                                if (n != number) return;
                                std::vector<double> u;
                                for (int a = 0; a < D; ++a) {
                                  const double t = (point.position[a] + 0.5) * 4;
                                  const double low = std::max(texel[a] - 0.35, 0.0);
                                  u.push_back((t - low) / (std::min(texel[a] + 0.35, 4.0) - low));
                                }
                                histogram.add(u);
                              });
      }
      EXPECT_TRUE(histogram.uniform());
    }
  });
}

}  // namespace
}  // namespace leaflight
