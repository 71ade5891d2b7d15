// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/mesh_direct_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

constexpr std::size_t rays_per_piece = 256;
// Work of a shadow ray, in the unit of the progress: points of lines.
constexpr double points_of_lines_per_ray = 48;

// Assigns to each vertex the set of light points that its neighbors and their neighbors use least.
std::vector<std::uint8_t> sets_of(const MeshNeighbors& neighbors, std::size_t vertices) {
  constexpr std::uint8_t none = light_point_sets;
  constexpr int near = 64;  // weight of a neighbor relative to all of its neighbors
  std::vector<std::uint8_t> sets(vertices, none);
  for (std::size_t v = 0; v < vertices; ++v) {
    std::array<int, light_point_sets + 1> uses{};
    for (const std::uint32_t* u = neighbors.begin(v); u != neighbors.end(v); ++u) {
      uses[sets[*u]] += near;
      for (const std::uint32_t* w = neighbors.begin(*u); w != neighbors.end(*u); ++w) {
        ++uses[sets[*w]];
      }
    }
    sets[v] =
        static_cast<std::uint8_t>(std::min_element(uses.begin(), uses.end() - 1) - uses.begin());
  }
  return sets;
}

// Returns, by the number of a light point modulo `share`, the vertex that traces the shadow ray to
// it. This is the nearest of the neighbors and their neighbors whose turn it is, or else the vertex
// itself.
std::array<std::uint32_t, light_point_sets> turns(const MeshNeighbors& neighbors,
                                                  const std::vector<std::uint8_t>& sets,
                                                  std::size_t vertex, std::size_t share) {
  std::array<std::uint32_t, light_point_sets> found;
  const auto none = static_cast<std::uint32_t>(sets.size());
  found.fill(none);
  std::size_t missing = share;
  const auto offer = [&](std::uint32_t u) {
    std::uint32_t& turn = found[(light_point_sets * share - sets[u]) % share];
    if (turn == none) turn = u, --missing;
  };
  const std::uint32_t *begin = neighbors.begin(vertex), *end = neighbors.end(vertex);
  std::for_each(begin, end, offer);
  for (const std::uint32_t* u = begin; missing > 0 && u != end; ++u) {
    std::for_each(neighbors.begin(*u), neighbors.end(*u), offer);
  }
  std::replace(found.begin(), found.end(), none, static_cast<std::uint32_t>(vertex));
  return found;
}

// A shadow ray from a point to a source, relative to the front of the point's facet.
template <int D>
struct ShadowRay {
  Vec<D> direction{0.0};  // unit
  double share = 0;       // of the source's amount

  ShadowRay(const LightSource<D>& source, const SurfacePoint<D>& from) {
    const Vec<D> to_source = source.infinite ? -source.direction : source.position - from.position;
    const double distance = to_source.length();
    if (!(distance > 0)) return;
    direction = to_source / distance;
    share = direction.dot(from.geometric_normal) * source.strength(-direction, distance);
  }
};

template <int D>
BlockingIsovalues blocking(const ShadowRay<D>& ray, const LightSource<D>& source,
                           SurfacePoint<D> from, const SceneTracer<D>& tracer) {
  if (ray.share == 0) return {0, 0};
  if (ray.share < 0) from.geometric_normal = -from.geometric_normal;
  if (source.infinite) return tracer.blocking(from, ray.direction);
  const bool faces_away = source.normal.dot(ray.direction) > 0;
  return tracer.blocking(from, source.position, faces_away ? -source.normal : source.normal);
}

}  // namespace

template <int D>
MeshDirectLight<D>::MeshDirectLight(const SceneTracer<D>& tracer)
    : sets_(interleaved_points(tracer)), scales_(tracer.lights().size() + 1, Rgb(1)) {}

template <int D>
MeshDirectLight<D>::MeshDirectLight(const SceneTracer<D>& tracer,
                                    const std::vector<SubdividedMesh<D>>& meshes,
                                    Progress& progress, std::size_t share,
                                    const MeshDirectLight* earlier)
    : MeshDirectLight(tracer) {
  auto traced = std::make_shared<std::vector<MeshRays>>(meshes.size());
  Known known = earlier ? known_of(*earlier) : Known{};
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (tracer.meshes()[m].scattering != Scattering::diffuse) continue;
    if (earlier) known.rays = &earlier->rays(static_cast<int>(m));
    (*traced)[m] = trace_mesh(tracer, meshes[m].fine, progress, share, known);
  }
  meshes_ = std::move(traced);
}

template <int D>
MeshDirectLight<D>::MeshDirectLight(const SceneTracer<D>& tracer, std::vector<MeshRays> traced)
    : MeshDirectLight(tracer) {
  meshes_ = std::make_shared<const std::vector<MeshRays>>(std::move(traced));
}

template <int D>
typename MeshDirectLight<D>::MeshRays MeshDirectLight<D>::opened(const SceneTracer<D>& tracer,
                                                                 const FineMesh<D>& mesh) const {
  return opened(tracer, mesh, {});
}

template <int D>
void MeshDirectLight<D>::trace(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                               const BakePart& vertices, Progress& progress,
                               MeshRays& traced) const {
  trace_vertices(tracer, mesh, vertices, 1, {}, progress, traced);
}

template <int D>
void MeshDirectLight<D>::trace_vertices(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                                        const BakePart& vertices, std::size_t share,
                                        const Known& known, Progress& progress,
                                        MeshRays& traced) const {
  const double rays = static_cast<double>(sets_[0].size()) / static_cast<double>(share);
  parallel_range(vertices.end - vertices.begin, rays_per_piece, points_of_lines_per_ray * rays,
                 progress, [&](std::size_t begin, std::size_t end) {
                   for (std::size_t v = begin; v < end && !progress.cancelled(); ++v) {
                     trace_vertex(tracer, mesh, vertices.begin + v, share, known, traced);
                   }
                 });
}

template <int D>
typename MeshDirectLight<D>::Known MeshDirectLight<D>::known_of(
    const MeshDirectLight& earlier) const {
  Known known;
  known.points = earlier.sets_[0].size();
  constexpr int open = -2;
  known.lights.assign(lights(), open);
  for (std::size_t set = 0; set < sets_.size(); ++set) {
    const std::vector<LightPoint<D>>& before = earlier.sets_[set];
    known.numbers.push_back(same_points(sets_[set], before));
    for (std::size_t i = 0; i < sets_[set].size(); ++i) {
      const int number = known.numbers[set][i];
      const bool same = number >= 0 && before[number].source.amount == sets_[set][i].source.amount;
      const int light = same ? static_cast<int>(earlier.place_of(before[number])) : -1;
      int& found = known.lights[place_of(sets_[set][i])];
      if (found == open) found = light;
      if (found != light) found = -1;
    }
  }
  return known;
}

template <int D>
MeshDirectLight<D> MeshDirectLight<D>::scaled(const std::vector<Rgb>& lights) const {
  MeshDirectLight<D> result = *this;
  for (auto& set : result.sets_) scale_points(lights, set);
  for (std::size_t l = 0; l < lights.size(); ++l) result.scales_.at(l) *= lights[l];
  return result;
}

template <int D>
typename MeshDirectLight<D>::MeshRays MeshDirectLight<D>::opened(const SceneTracer<D>& tracer,
                                                                 const FineMesh<D>& mesh,
                                                                 const Known& known) const {
  const std::size_t vertices = mesh.vertices.size();
  MeshRays traced{known.rays ? known.rays->neighbors : MeshNeighbors(vertices, mesh.facets),
                  known.rays ? known.rays->sets : sets_of(traced.neighbors, vertices),
                  {},
                  {},
                  {}};
  traced.rays.resize(vertices * sets_[0].size());
  if (tracer.has_openings()) traced.least.resize(traced.rays.size());
  for (auto& side : traced.unshadowed) side.resize(lights() * vertices);
  return traced;
}

template <int D>
void MeshDirectLight<D>::trace_vertex(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                                      std::size_t vertex, std::size_t share, const Known& known,
                                      MeshRays& traced) const {
  const std::size_t vertices = traced.sets.size(), points = sets_[0].size();
  for (auto& side : traced.unshadowed) {
    for (std::size_t light = 0; light < lights(); ++light) {
      side[light * vertices + vertex] = Vec<3, float>(0);
    }
  }
  if (known.rays) take(known, vertex, traced);
  const SurfacePoint<D> from = vertex_point(tracer, mesh, vertex, true, 0);
  const Vec<3, float> brdf(from.albedo / static_cast<Real>(projected_hemisphere<D>));
  const auto turn = turns(traced.neighbors, traced.sets, vertex, share);
  for (std::size_t set = 0; set < sets_.size(); ++set) {
    for (std::size_t i = 0; i < points; ++i) {
      const LightSource<D>& source = sets_[set][i].source;
      const std::size_t light = place_of(sets_[set][i]);
      if (known.has(light)) continue;
      const ShadowRay<D> ray(source, from);
      traced.unshadowed[ray.share < 0][light * vertices + vertex] +=
          Vec<3, float>(source.amount) * brdf *
          static_cast<float>(std::abs(ray.share) / light_point_sets);
      if (set != traced.sets[vertex]) continue;
      traced.rays[vertex * points + i].share = static_cast<float>(ray.share);
      if (turn[i % share] != vertex) continue;
      const BlockingIsovalues isosurfaces = blocking(ray, source, from, tracer);
      traced.rays[vertex * points + i].greatest = static_cast<float>(isosurfaces.greatest);
      if (!traced.least.empty()) {
        traced.least[vertex * points + i] = static_cast<float>(isosurfaces.least);
      }
    }
  }
}

template <int D>
typename MeshDirectLight<D>::MeshRays MeshDirectLight<D>::trace_mesh(const SceneTracer<D>& tracer,
                                                                     const FineMesh<D>& mesh,
                                                                     Progress& progress,
                                                                     std::size_t share,
                                                                     const Known& known) const {
  MeshRays traced = opened(tracer, mesh, known);
  BakePart all{PartKind::shadows};
  all.end = mesh.vertices.size();
  trace_vertices(tracer, mesh, all, share, known, progress, traced);
  if (share > 1) take_from_neighbors(traced, share, known);
  return traced;
}

template <int D>
void MeshDirectLight<D>::take_from_neighbors(MeshRays& traced, std::size_t share,
                                             const Known& known) const {
  const std::size_t points = sets_[0].size();
  for (std::size_t v = 0; v < traced.sets.size(); ++v) {
    const auto turn = turns(traced.neighbors, traced.sets, v, share);
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t entry = v * points + i, other = turn[i % share] * points + i;
      if (known.has(place_of(sets_[traced.sets[v]][i]))) continue;
      traced.rays[entry].greatest = traced.rays[other].greatest;
      if (!traced.least.empty()) traced.least[entry] = traced.least[other];
    }
  }
}

template <int D>
void MeshDirectLight<D>::take(const Known& known, std::size_t vertex, MeshRays& to) const {
  const MeshRays& from = *known.rays;
  const std::vector<LightPoint<D>>& set = sets_[to.sets[vertex]];
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (!known.has(place_of(set[i]))) continue;
    const std::size_t same = vertex * known.points + known.numbers[to.sets[vertex]][i];
    to.rays[vertex * set.size() + i] = from.rays[same];
    if (!to.least.empty()) to.least[vertex * set.size() + i] = from.least[same];
  }
  const std::size_t vertices = to.sets.size();
  for (std::size_t light = 0; light < lights(); ++light) {
    if (!known.has(light)) continue;
    for (const int side : {0, 1}) {
      to.unshadowed[side][light * vertices + vertex] =
          from.unshadowed[side][known.lights[light] * vertices + vertex];
    }
  }
}

template <int D>
std::vector<Vec<3, float>> MeshDirectLight<D>::unshadowed(int mesh, bool back) const {
  const MeshRays& traced = (*meshes_)[mesh];
  const std::size_t vertices = traced.sets.size();
  std::vector<Vec<3, float>> sums(vertices, Vec<3, float>(0));
  for (std::size_t l = 0; vertices > 0 && l < scales_.size(); ++l) {
    const Vec<3, float>* light = &traced.unshadowed[back][l * vertices];
    for (std::size_t v = 0; v < vertices; ++v) sums[v] += light[v] * Vec<3, float>(scales_[l]);
  }
  return sums;
}

template <int D>
std::vector<Vec<3, float>> MeshDirectLight<D>::unshadowed_by(std::size_t light, int mesh,
                                                             bool back) const {
  const MeshRays& traced = (*meshes_)[mesh];
  const std::size_t vertices = traced.sets.size();
  const auto begin =
      traced.unshadowed[back].begin() + static_cast<std::ptrdiff_t>(light * vertices);
  std::vector<Vec<3, float>> radiance(begin, begin + static_cast<std::ptrdiff_t>(vertices));
  for (Vec<3, float>& each : radiance) each *= Vec<3, float>(scales_[light]);
  return radiance;
}

template <int D>
std::vector<Vec<3, float>> MeshDirectLight<D>::radiance(int mesh, double c, bool back) const {
  const MeshRays& traced = (*meshes_)[mesh];
  std::vector<Vec<3, float>> radiance = unshadowed(mesh, back);
  const Vec<3, float> dark(0);
  if (std::all_of(radiance.begin(), radiance.end(), [&](const auto& r) { return r == dark; })) {
    return radiance;
  }
  const std::size_t points = sets_[0].size();
  std::vector<Vec<3, float>> amounts;  // [set * points + point]
  for (const auto& set : sets_) {
    for (const LightPoint<D>& point : set) amounts.emplace_back(point.source.amount);
  }
  const auto isovalue = static_cast<float>(c);
  const float side = back ? -1 : 1;
  // Shares of the light that reach each vertex.
  std::vector<Vec<3, float>> reaching(radiance.size());
  parallel_each(radiance.size(), [&](std::size_t v) {
    Vec<3, float> all(0), lit(0);
    for (std::size_t i = 0; i < points; ++i) {
      const TracedRay& ray = traced.rays[v * points + i];
      const Vec<3, float> light =
          amounts[traced.sets[v] * points + i] * std::max(0.0f, side * ray.share);
      all += light;
      const bool passes = !traced.least.empty() && isovalue <= traced.least[v * points + i];
      if (ray.greatest < isovalue || passes) lit += light;
    }
    for (int k = 0; k < 3; ++k) reaching[v][k] = all[k] > 0 ? lit[k] / all[k] : 0;
  });
  parallel_each(radiance.size(), [&](std::size_t v) {
    const std::uint32_t *begin = traced.neighbors.begin(v), *end = traced.neighbors.end(v);
    Vec<3, float> sum(0);
    for (const std::uint32_t* u = begin; u != end; ++u) sum += reaching[*u];
    radiance[v] *= sum / static_cast<float>(end - begin);
  });
  return radiance;
}

template <int D>
double work_of_shadow_rays(const SceneTracer<D>& tracer,
                           const std::vector<SubdividedMesh<D>>& meshes, std::size_t share) {
  double vertices = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (tracer.meshes()[m].scattering != Scattering::diffuse) continue;
    vertices += static_cast<double>(meshes[m].fine.vertices.size());
  }
  return points_of_lines_per_ray * vertices *
         static_cast<double>(interleaved_points(tracer)[0].size()) / static_cast<double>(share);
}

template class MeshDirectLight<2>;
template class MeshDirectLight<3>;
template double work_of_shadow_rays(const SceneTracer<2>&, const std::vector<SubdividedMesh<2>>&,
                                    std::size_t);
template double work_of_shadow_rays(const SceneTracer<3>&, const std::vector<SubdividedMesh<3>>&,
                                    std::size_t);

}  // namespace leaflight
