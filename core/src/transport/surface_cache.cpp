// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/surface_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/low_discrepancy.h"
#include "base/parallel.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

constexpr std::size_t nodes = IsovalueNodes::count;
// Approximate number of patches of the walls if their facets are large.
template <int D>
constexpr double coarse_patches = D == 3 ? 8192 : 1024;
template <int D>
constexpr double fine_patches = D == 3 ? 32768 : 2048;
constexpr int most_cuts = 512;
// Passes of collect_photons(); each reaches one patch further.
constexpr int patch_passes = 4;

// The patches of a facet. A segment has n pieces. A triangle has n^2, numbered by the square (i, j)
// of their barycentric coordinates. A square below the diagonal contains two of them, so row j
// starts after j rows of 2 (n - j') - 1.
template <int D>
struct Patches;

// Patches that share an edge with a patch; the patch itself at the facet's border.
template <int D>
using Beside = std::array<int, static_cast<std::size_t>(D)>;

template <>
struct Patches<2> {
  static int count(int cuts) { return cuts; }
  static std::vector<Beside<2>> beside(int cuts) {
    std::vector<Beside<2>> beside(cuts);
    for (int i = 0; i < cuts; ++i) beside[i] = {std::max(i - 1, 0), std::min(i + 1, cuts - 1)};
    return beside;
  }
  static int number(double u, double, int cuts) {
    return std::clamp(static_cast<int>(u * cuts), 0, cuts - 1);
  }
  static std::array<double, 2> point(int number, int cuts, const std::array<double, 2>& random) {
    return {(number + random[0]) / cuts, 0};
  }
};

template <>
struct Patches<3> {
  static int count(int cuts) { return cuts * cuts; }
  static std::vector<Beside<3>> beside(int cuts) {
    const auto at = [&](int i, int j, int upper) { return j * (2 * cuts - j) + 2 * i + upper; };
    std::vector<Beside<3>> beside;
    for (int j = 0; j < cuts; ++j) {
      for (int i = 0; i < cuts - j; ++i) {
        const int lower = at(i, j, 0);
        const bool has_upper = i + j + 1 < cuts;
        beside.push_back({has_upper ? at(i, j, 1) : lower, i > 0 ? at(i - 1, j, 1) : lower,
                          j > 0 ? at(i, j - 1, 1) : lower});
        if (has_upper) beside.push_back({lower, at(i + 1, j, 0), at(i, j + 1, 0)});
      }
    }
    return beside;
  }
  static int number(double u, double v, int cuts) {
    const double x = u * cuts, y = v * cuts;
    const int j = std::clamp(static_cast<int>(y), 0, cuts - 1);
    const int i = std::clamp(static_cast<int>(x), 0, cuts - 1 - j);
    const bool upper = (x - i) + (y - j) > 1 && i < cuts - 1 - j;
    return j * (2 * cuts - j) + 2 * i + upper;
  }
  static std::array<double, 2> point(int number, int cuts, const std::array<double, 2>& random) {
    int j = 0;
    while ((j + 1) * (2 * cuts - j - 1) <= number) ++j;
    const int k = number - j * (2 * cuts - j);
    double s = random[0], t = random[1];
    if (s + t > 1) s = 1 - s, t = 1 - t;
    if (k % 2) s = 1 - s, t = 1 - t;
    const int i = k / 2;
    return {(i + s) / cuts, (j + t) / cuts};
  }
};

// True if the scene's box reaches in front of a plane.
template <int D>
bool sees_anything(const SceneTracer<D>& tracer, const Vec<D>& point, const Vec<D>& normal) {
  const Box<D>& box = tracer.box();
  double farthest_in_front = 0;
  for (int a = 0; a < D; ++a) {
    farthest_in_front +=
        std::max((box.low[a] - point[a]) * normal[a], (box.high[a] - point[a]) * normal[a]);
  }
  return farthest_in_front > 1e-6 * tracer.bounds().radius;
}

// Averages each patch with its neighbors; the index is patch * stride + ...
template <int D>
void spread_over_patches(const std::vector<Beside<D>>& beside, std::size_t stride,
                         std::vector<Rgb>& light) {
  for (int pass = 0; pass < patch_passes; ++pass) {
    const std::vector<Rgb> before = light;
    for (std::size_t e = 0; e < light.size(); ++e) {
      for (const int other : beside[e / stride]) light[e] += before[other * stride + e % stride];
      light[e] /= D + 1;
    }
  }
}

}  // namespace

template <int D>
SurfaceCache<D>::SurfaceCache(const SceneTracer<D>& tracer, bool caustics, double photon_flux,
                              std::uint64_t photons, bool fine)
    : tracer_(tracer), nodes_(tracer.scene()), indirect_sides_(0, 1, 1), caustic_(0, 1, 1) {
  double total_area = 0;
  for (std::size_t m = 0; m < tracer.meshes().size(); ++m) {
    const Mesh<D>& mesh = tracer.meshes()[m];
    first_facet_.push_back(facets_.size());
    for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
      const FacetFrame<D> frame(mesh, i);
      const bool back = sees_anything<D>(tracer, frame.point(0, 0), -frame.normal());
      const bool front = !back || sees_anything<D>(tracer, frame.point(0, 0), frame.normal());
      facets_.push_back({static_cast<int>(m), static_cast<int>(i), 1, front, back, 0, 0,
                         frame.area(), frame.normal()});
      total_area += frame.area();
    }
  }
  const double wanted = fine ? fine_patches<D> : coarse_patches<D>;
  std::size_t patches = 0, entries = 0;
  for (Facet& facet : facets_) {
    const double share = total_area > 0 ? facet.patch_area / total_area : 0;
    const double cuts = std::pow(share * wanted, 1.0 / (D - 1));
    facet.cuts = std::clamp(static_cast<int>(std::lround(cuts)), 1, most_cuts);
    facet.patch_area /= Patches<D>::count(facet.cuts);
    facet.first_patch = patches;
    facet.first_entry = entries;
    patches += Patches<D>::count(facet.cuts);
    entries += Patches<D>::count(facet.cuts) * facet.sides() * nodes;
  }
  if (entries > std::size_t{1} << 28) {
    throw Error("The walls have " + std::to_string(facets_.size()) +
                " faces, too many for their radiance cache; decimate the meshes.");
  }
  radiance_.assign(entries, Rgb(0));
  if (photons == 0) return;
  indirect_sides_ = FluxAccumulator(entries, photon_flux, photons);
  if (caustics) caustic_ = FluxAccumulator(entries, photon_flux, photons);
}

template <int D>
std::optional<std::size_t> SurfaceCache<D>::column(const MeshHit& hit,
                                                   const Vec<D>& direction) const {
  const Facet& facet = facets_[first_facet_[hit.mesh] + hit.facet];
  const bool back = facet.normal.dot(direction) > 0;
  if (!(back ? facet.back : facet.front)) return std::nullopt;
  const std::size_t patch = Patches<D>::number(hit.u, hit.v, facet.cuts);
  return facet.first_entry + (patch * facet.sides() + (back && facet.front)) * nodes;
}

template <int D>
typename SurfaceCache<D>::Place SurfaceCache<D>::place_of(std::size_t entry) const {
  const Facet& facet =
      *(std::upper_bound(facets_.begin(), facets_.end(), entry,
                         [](std::size_t e, const Facet& f) { return e < f.first_entry; }) -
        1);
  const std::size_t column = (entry - facet.first_entry) / nodes;
  return {facet, static_cast<int>(column / facet.sides()),
          facet.front && column % facet.sides() == 0,
          static_cast<int>((entry - facet.first_entry) % nodes)};
}

template <int D>
void SurfaceCache<D>::deposit(const PhotonHit<D>& photon) {
  if (photon.arrival == Arrival::direct) return;
  const auto first = column(photon.point.facet(), -photon.point.geometric_normal);
  if (!first) return;
  const bool is_caustic = photon.arrival == Arrival::caustic && !caustic_.empty();
  FluxAccumulator& flux = is_caustic ? caustic_ : indirect_sides_;
  flux.add(*first + nodes_.nearest(photon.point.c), photon.flux_height);
}

template <int D>
double SurfaceCache<D>::share_of_range(int node) const {
  return nodes_.height(node) / tracer_.scene().isovalue_range.height();
}

// Returns the irradiance from an entry's photons.
template <int D>
Rgb SurfaceCache<D>::density(const FluxAccumulator& flux, std::size_t entry) const {
  if (flux.empty()) return Rgb(0);
  const Place at = place_of(entry);
  const double measure = at.facet.patch_area * share_of_range(at.node);
  if (!(measure > 0)) return Rgb(0);
  Rgb irradiance;
  for (int i = 0; i < 3; ++i) irradiance[i] = static_cast<Real>(flux.flux(entry, i) / measure);
  return irradiance;
}

// Averages photons over patches, because a patch has few photons and indirect light varies little
// between patches. Isovalues are not averaged: light may vary fast where an isosurface leaves the
// walls.
template <int D>
void SurfaceCache<D>::collect_photons(bool smooth, Progress& progress) {
  parallel_each(facets_.size(), 1, progress, [&](std::size_t f) {
    const std::vector<Beside<D>> beside = Patches<D>::beside(facets_[f].cuts);
    const std::size_t stride = facets_[f].sides() * nodes, first = facets_[f].first_entry;
    std::vector<Rgb> light(beside.size() * stride);
    for (std::size_t e = 0; e < light.size(); ++e) light[e] = density(indirect_sides_, first + e);
    if (smooth) spread_over_patches<D>(beside, stride, light);
    std::copy(light.begin(), light.end(), radiance_.begin() + first);
  });
  if (smooth) indirect_sides_ = FluxAccumulator(0, 1, 1);
}

template <int D>
void SurfaceCache<D>::finish(std::size_t column, const LightSampler<D>& lights, int samples,
                             std::uint64_t seed, std::uint64_t& rays) {
  const std::size_t first = column * nodes;
  const auto& [facet, patch, front, node] = place_of(first);
  SurfacePoint<D> point =
      tracer_.facet_point(facet.mesh, facet.facet, 0, 0, front, nodes_.node(node));
  if (point.scattering != Scattering::diffuse) return;  // no ray looks it up
  // The key is that of the patch and side, so that the set of stored sides does not change the
  // light.
  const std::size_t key = (facet.first_patch + patch) * 2 + !front;
  Random random = random_for(seed, Purpose::surface_cache, key);
  const std::uint64_t point_key = random.bits(), light_key = random.bits();
  const Mesh<D>& mesh = tracer_.meshes()[facet.mesh];
  const FacetFrame<D> frame(mesh, facet.facet);
  std::array<Rgb, nodes> direct;
  direct.fill(Rgb(0));
  Rgb albedo(0);
  for (int i = 0; i < samples; ++i) {
    const auto uv = Patches<D>::point(patch, facet.cuts, sobol_point(i, point_key));
    point.position = frame.point(uv[0], uv[1]);
    if (mesh.texture) point.albedo = mesh.albedo_at(facet.facet, uv[0], uv[1]);
    albedo += point.albedo;
    const auto light = lights.direct_radiance_for_all(point, (i + random.uniform()) / samples,
                                                      sobol_point(i, light_key), rays);
    for (std::size_t n = 0; n < nodes; ++n) {
      if (!light.blocked.include(nodes_.node(static_cast<int>(n)))) direct[n] += light.radiance;
    }
  }
  const auto brdf = static_cast<Real>(1 / projected_hemisphere<D>);
  for (std::size_t n = 0; n < nodes; ++n) {
    Rgb& radiance = radiance_[first + n];
    radiance = (albedo * brdf * (radiance + density(caustic_, first + n)) + direct[n]) /
               static_cast<Real>(samples);
  }
}

template <int D>
Rgb SurfaceCache<D>::between_nodes(const FluxAccumulator& flux,
                                   const SurfacePoint<D>& point) const {
  // The point's normal faces the side from which it is seen.
  const auto first = column(point.facet(), -point.geometric_normal);
  if (!first) return Rgb(0);
  const IsovalueNodes::Place at = nodes_.place(point.c);
  const auto t = static_cast<Real>(at.t);
  return density(flux, *first + at.low) * (1 - t) + density(flux, *first + at.low + 1) * t;
}

template <int D>
Rgb SurfaceCache<D>::radiance(const MeshHit& hit, const Vec<D>& direction, double c,
                              double u) const {
  const auto first = column(hit, direction);
  if (!first) return Rgb(0);
  const IsovalueNodes::Place at = nodes_.place(c);
  return radiance_[*first + at.low + (u < at.t)];
}

template class SurfaceCache<2>;
template class SurfaceCache<3>;

}  // namespace leaflight
