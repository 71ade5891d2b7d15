// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/surface_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "leaflight/math/error.h"
#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

constexpr int isovalue_bins = 32;
constexpr int sides = 2;
// Patches the surroundings are cut into, about, when their triangles are large.
constexpr double target_patches = 8192;
constexpr int most_cuts = 64;

struct Corners {
  Vec3 a, ab, ac;
};

Corners corners(const Mesh& mesh, int triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3 a(mesh.vertices[t[0]]);
  return {a, Vec3(mesh.vertices[t[1]]) - a, Vec3(mesh.vertices[t[2]]) - a};
}

double area(const Corners& c) { return 0.5 * c.ab.cross(c.ac).length(); }

// Patches of a triangle are numbered by the lattice square (i, j) of their barycentric coordinates;
// a square below the diagonal holds two of them. Row j begins after j rows of 2 (cuts - j') - 1.
int patch_number(double u, double v, int cuts) {
  const double x = u * cuts, y = v * cuts;
  int j = std::clamp(static_cast<int>(y), 0, cuts - 1);
  int i = std::clamp(static_cast<int>(x), 0, cuts - 1 - j);
  const bool upper = (x - i) + (y - j) > 1 && i < cuts - 1 - j;
  return j * (2 * cuts - j) + 2 * i + upper;
}

// A uniform point (u, v) of a patch.
std::array<double, 2> patch_point(int number, int cuts, const std::array<double, 2>& random) {
  int j = 0;
  while ((j + 1) * (2 * cuts - j - 1) <= number) ++j;
  const int k = number - j * (2 * cuts - j);
  double s = random[0], t = random[1];
  if (s + t > 1) s = 1 - s, t = 1 - t;
  if (k % 2) s = 1 - s, t = 1 - t;
  return {(k / 2 + s) / cuts, (j + t) / cuts};
}

}  // namespace

SurfaceCache::SurfaceCache(const SceneTracer& tracer, double photon_flux, std::uint64_t photons)
    : tracer_(tracer), flux_(0, 1, 1) {
  double total_area = 0;
  for (const Mesh& mesh : tracer.meshes()) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      total_area += area(corners(mesh, static_cast<int>(i)));
    }
  }
  const double patch_area = total_area / target_patches;
  std::size_t patches = 0;
  for (std::size_t m = 0; m < tracer.meshes().size(); ++m) {
    const Mesh& mesh = tracer.meshes()[m];
    triangle_of_.emplace_back();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Corners c = corners(mesh, static_cast<int>(i));
      Triangle triangle{static_cast<int>(m),          static_cast<int>(i), 1, patches, area(c),
                        c.ab.cross(c.ac).normalized()};
      if (patch_area > 0) {
        const double cuts = std::sqrt(triangle.patch_area / patch_area);
        triangle.cuts = std::clamp(static_cast<int>(std::lround(cuts)), 1, most_cuts);
      }
      triangle.patch_area /= triangle.cuts * triangle.cuts;
      patches += static_cast<std::size_t>(triangle.cuts) * triangle.cuts;
      triangle_of_.back().push_back(triangles_.size());
      triangles_.push_back(triangle);
    }
  }
  const std::size_t entries = patches * sides * isovalue_bins;
  if (entries > std::size_t{1} << 28) {
    throw Error("The surroundings have " + std::to_string(triangles_.size()) +
                " triangles, too many for their radiance cache; decimate the meshes.");
  }
  radiance_.assign(entries, Rgb(0));
  flux_ = FluxAccumulator(entries, photon_flux, photons);
}

std::size_t SurfaceCache::entry(const SurroundingsHit& hit, const Vec3& direction,
                                double isovalue) const {
  const Triangle& triangle = triangles_[triangle_of_[hit.mesh][hit.triangle]];
  const std::size_t patch = triangle.first + patch_number(hit.u, hit.v, triangle.cuts);
  const IsovalueWindow& window = tracer_.scene().window;
  const double position = (isovalue - window.min) / window.height() * isovalue_bins;
  const int bin = std::clamp(static_cast<int>(position), 0, isovalue_bins - 1);
  const int side = triangle.normal.dot(direction) > 0;
  return (patch * sides + side) * isovalue_bins + bin;
}

void SurfaceCache::deposit(const PhotonHit& photon) {
  if (photon.direct) return;
  // The point's normal faces the side from which the photon came.
  const Vec3 arrival = -photon.point.geometric_normal;
  flux_.add(entry(photon.hit.surroundings, arrival, photon.point.isovalue), photon.flux_height);
}

void SurfaceCache::finish(std::size_t entry, const LightSampler& lights, int samples,
                          std::uint64_t seed, std::uint64_t& rays) {
  const std::size_t patch = entry / (sides * isovalue_bins);
  const int side = static_cast<int>(entry / isovalue_bins) % sides;
  const int bin = static_cast<int>(entry % isovalue_bins);
  const auto after = std::upper_bound(triangles_.begin(), triangles_.end(), patch,
                                      [](std::size_t p, const Triangle& t) { return p < t.first; });
  const Triangle& triangle = *(after - 1);
  const Mesh& mesh = tracer_.meshes()[triangle.mesh];
  const IsovalueWindow& window = tracer_.scene().window;
  const double bin_height = window.height() / isovalue_bins;
  const Corners c = corners(mesh, triangle.triangle);

  SurfacePoint point;
  point.kind = HitKind::surroundings;
  point.geometric_normal = side == 0 ? triangle.normal : -triangle.normal;
  point.shading_normal = point.geometric_normal;
  point.albedo = mesh.albedo;
  Random random = random_for(seed, Purpose::surface_cache, entry);
  const std::uint64_t point_key = random.bits(), light_key = random.bits();
  Rgb sum(0);
  for (int i = 0; i < samples; ++i) {
    const auto uv = patch_point(static_cast<int>(patch - triangle.first), triangle.cuts,
                                sobol_point(i, point_key));
    point.position = c.a + c.ab * uv[0] + c.ac * uv[1];
    point.isovalue = window.min + bin_height * (bin + (i + random.uniform()) / samples);
    sum += lights.direct_radiance(point, random.uniform(), sobol_point(i, light_key), rays);
  }
  const double density = 1 / (pi * triangle.patch_area * bin_height);
  Rgb radiance = sum / static_cast<Real>(samples);
  for (int i = 0; i < 3; ++i) {
    radiance[i] += mesh.albedo[i] * static_cast<Real>(flux_.flux(entry, i) * density);
  }
  radiance_[entry] = radiance;
}

Rgb SurfaceCache::radiance(const SurroundingsHit& hit, const Vec3& direction,
                           double isovalue) const {
  return radiance_[entry(hit, direction, isovalue)];
}

}  // namespace leaflight
