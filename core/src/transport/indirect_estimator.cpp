// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/indirect_estimator.h"

#include <cmath>
#include <limits>

#include "base/sampling.h"

namespace leaflight {
namespace {

// True if a direction leaves the traced surface. Light from below it does not arrive, for any
// shading normal.
template <int D>
bool leaves_surface(const SurfacePoint<D>& point, const Vec<D>& direction) {
  return direction.dot(point.geometric_normal) > 0;
}

template <int D>
double length_of(const Hit<D>& hit) {
  if (hit.kind == HitKind::none) return std::numeric_limits<double>::infinity();
  return hit.kind == HitKind::isosurface ? hit.isosurface.t : hit.on_mesh.t;
}

// A ray through mirrors and glass to the first diffuse surface, or out of the scene.
template <int D>
struct Sight {
  Hit<D> hit;
  SurfacePoint<D> point;  // of kind none if the ray left the scene
  Vec<D> direction;       // of the last ray
  Rgb throughput{1};
  bool specular = false;
};

// Follows a ray. Calls passed(origin, direction, t, sight) for each segment, and reached(sight) for
// each surface.
template <int D, class Passed, class Reached>
Sight<D> look(const SceneTracer<D>& tracer, const SurfacePoint<D>& start, const Vec<D>& direction,
              Random& random, std::uint64_t& rays, Passed passed, Reached reached) {
  Sight<D> sight;
  sight.direction = direction;
  SurfacePoint<D> from = start;
  for (int bounces = 0; bounces < most_specular_bounces; ++bounces) {
    ++rays;
    sight.hit = tracer.intersect(from, sight.direction);
    passed(from.position, sight.direction, length_of(sight.hit), sight);
    if (sight.hit.kind == HitKind::none) break;
    sight.point = tracer.surface_point(sight.hit, sight.direction, start.c);
    reached(sight);
    if (sight.point.scattering == Scattering::diffuse) return sight;
    const SpecularBounce<D> bounce =
        specular_bounce(sight.point, sight.direction, random.uniform());
    sight.throughput *= bounce.weight * bounce.radiance_scale;
    sight.specular = true;
    sight.direction = bounce.direction;
    from = bounce.from;
    if (!(largest(sight.throughput) > 0)) break;
  }
  sight.hit.kind = HitKind::none;
  sight.point.on = std::monostate();
  return sight;
}

template <int D>
class PathEstimator final : public IndirectEstimator<D> {
 public:
  PathEstimator(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                const CausticPhotons<D>* photons)
      : tracer_(tracer), lights_(lights), photons_(photons) {}

  Rgb indirect_radiance(const SurfacePoint<D>& start, const std::array<double, 2>& u,
                        Random& random, std::uint64_t& rays) const override {
    SurfacePoint<D> point = start;
    std::array<double, 2> sample = u;
    Rgb radiance(0), throughput(1);
    for (int bounce = 0; bounce < most_diffuse_bounces; ++bounce) {
      throughput *= point.albedo;
      const Real survival = std::min(Real(1), largest(throughput));
      if (!(random.uniform() < survival)) return radiance;
      throughput /= survival;
      const Vec<D> direction = sample_cosine_hemisphere<D>(point.shading_normal, sample);
      if (!leaves_surface(point, direction)) return radiance;
      const Sight<D> sight = look<D>(
          tracer_, point, direction, random, rays,
          // Lights are sampled at the diffuse surface. Only lights seen by mirrors and glass count
          // here, unless photons carry their light.
          [&](const Vec<D>& origin, const Vec<D>& along, double t, const Sight<D>& so_far) {
            if (!so_far.specular || photons_) return;
            radiance += throughput * so_far.throughput * lights_.visible_radiance(origin, along, t);
          },
          [&](const Sight<D>& so_far) {
            if (so_far.point.kind() == HitKind::isosurface || (so_far.specular && !photons_)) {
              radiance += throughput * so_far.throughput * so_far.point.emission;
            }
          });
      if (sight.point.kind() == HitKind::none) return radiance;
      throughput *= sight.throughput;
      point = sight.point;
      const double choice = random.uniform();
      const double light_u = random.uniform();
      const std::array<double, 2> on_light{light_u, random.uniform()};
      radiance += throughput * lights_.direct_radiance(point, choice, on_light, rays);
      if (photons_) {
        radiance += throughput * caustic_radiance(photons_->isosurfaces, photons_->walls, point);
      }
      sample[0] = random.uniform();
      sample[1] = random.uniform();
    }
    return radiance;
  }

 private:
  const SceneTracer<D>& tracer_;
  const LightSampler<D>& lights_;
  const CausticPhotons<D>* photons_;  // may be null
};

template <int D>
class GatherEstimator final : public IndirectEstimator<D> {
 public:
  GatherEstimator(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                  const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                  const SurfaceCache<D>& walls)
      : tracer_(tracer), lights_(lights), isosurfaces_(isosurfaces), walls_(walls) {
    for (std::size_t v = 0; v < isosurfaces.size(); ++v) {
      const IsosurfaceRadiance<D>& isosurface = isosurfaces[v];
      Affine<D> texel_to_frame = tracer.index_to_frame(static_cast<int>(v));
      for (int a = 0; a < D; ++a)
        texel_to_frame.column[a] *= isosurface.lattice->voxels_per_texel[a];
      frame_to_texels_.push_back(inverse(texel_to_frame));
      emissive_.push_back(tracer.scene().volumes[v].emission.largest() > 0);
    }
  }

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>& u,
                        Random& random, std::uint64_t& rays) const override {
    return gathered(point, u, random, rays, 0);
  }

 private:
  // Gather rays shorter than this, in texels, continue as paths, because texels that near mix
  // isosurfaces of other orientations. The number of such bounces is limited; most rays of a scan
  // hit nothing near (docs/decisions/thesis.md).
  static constexpr double near = 8;
  static constexpr int most_near_bounces = 4;
  // The same limit between walls, in widths of their patches. In a corner, half of all rays would
  // hit the same patch and show its noise.
  static constexpr double near_patches = 3;

  Rgb gathered(const SurfacePoint<D>& point, const std::array<double, 2>& u, Random& random,
               std::uint64_t& rays, int near_bounces) const {
    const Vec<D> direction = sample_cosine_hemisphere<D>(point.shading_normal, u);
    if (!leaves_surface(point, direction)) return Rgb(0);
    ++rays;
    const Hit<D> hit = tracer_.intersect(point, direction);
    if (near_bounces == most_near_bounces || !is_near(point, hit, direction)) {
      return point.albedo * incident(hit, direction, point.c, random, rays);
    }
    const SurfacePoint<D> hit_point = tracer_.surface_point(hit, direction, point.c);
    const double choice = random.uniform();
    const std::array<double, 2> on_light = random.pair(), next = random.pair();
    // Emission of walls is direct light.
    const Rgb emission = hit.kind == HitKind::isosurface ? hit_point.emission : Rgb(0);
    return point.albedo * (emission + lights_.direct_radiance(hit_point, choice, on_light, rays) +
                           caustic_radiance<D>(isosurfaces_, &walls_, hit_point) +
                           gathered(hit_point, next, random, rays, near_bounces + 1));
  }

  bool is_near(const SurfacePoint<D>& from, const Hit<D>& hit, const Vec<D>& direction) const {
    if (hit.kind == HitKind::none || scattering_of(hit) != Scattering::diffuse) return false;
    if (hit.kind == HitKind::mesh) {
      return from.kind() == HitKind::mesh &&
             hit.on_mesh.t < near_patches * walls_.patch_width(hit.on_mesh) &&
             !walls_.holds_caustics();
    }
    return frame_to_texels_[hit.volume].vector(direction * hit.isosurface.t).length2() <
           near * near;
  }

  // Returns incident light. A ray through mirrors or glass to a light is a caustic, which photons
  // carry.
  Rgb incident(Hit<D> hit, const Vec<D>& towards, double c, Random& random,
               std::uint64_t& rays) const {
    if (hit.kind == HitKind::none) return Rgb(0);
    if (scattering_of(hit) == Scattering::diffuse) return found(hit, towards, c, random);
    const SurfacePoint<D> first = tracer_.surface_point(hit, towards, c);
    const SpecularBounce<D> bounce = specular_bounce(first, towards, random.uniform());
    Rgb emitted(0);
    const Sight<D> sight = look<D>(
        tracer_, bounce.from, bounce.direction, random, rays,
        [](const Vec<D>&, const Vec<D>&, double, const Sight<D>&) {},
        [&](const Sight<D>& so_far) {
          const bool isosurface = so_far.point.kind() == HitKind::isosurface;
          const bool specular = so_far.point.scattering != Scattering::diffuse;
          if (isosurface && specular) emitted += so_far.throughput * so_far.point.emission;
        });
    Rgb radiance = emitted;
    if (sight.point.kind() != HitKind::none) {
      radiance += sight.throughput * found(sight.hit, sight.direction, c, random);
    }
    const Rgb emission = first.kind() == HitKind::isosurface ? first.emission : Rgb(0);
    return emission + bounce.weight * bounce.radiance_scale * radiance;
  }

  Scattering scattering_of(const Hit<D>& hit) const {
    return hit.kind == HitKind::isosurface ? tracer_.scene().volumes[hit.volume].scattering
                                           : tracer_.meshes()[hit.on_mesh.mesh].scattering;
  }

  Rgb found(const Hit<D>& hit, const Vec<D>& direction, double c, Random& random) const {
    if (hit.kind == HitKind::mesh) {
      return walls_.radiance(hit.on_mesh, direction, c, random.uniform());
    }
    const Volume<D>& volume = tracer_.scene().volumes[hit.volume];
    const Rgb emission = emissive_[hit.volume] ? volume.emission.at(c) : Rgb(0);
    const IsosurfaceRadiance<D>& known = isosurfaces_[hit.volume];
    const std::int32_t slot = slot_before(*known.lattice, volume.field, hit.isosurface);
    if (slot == TexelLattice<D>::inactive) return emission;
    return emission + known.radiance[hit.isosurface.from_above][slot];
  }

  // Returns the slot of the texel half a texel in front of the hit. Texels in a thin shell contain
  // light of both faces, so light of the front would leak inside.
  static std::int32_t slot_before(const TexelLattice<D>& lattice, const Field<D>& field,
                                  const IsosurfaceHit<D>& hit) {
    const Vec<D> position = hit.point.index_position();
    const Vec<D> gradient =
        geometric_gradient(load_corners(field, hit.point.cell), hit.point.local);
    const double length = gradient.length();
    if (length > 0) {
      const Vec<D> before = gradient * ((hit.from_above ? 0.5 : -0.5) / length);
      const std::int32_t slot = lattice.nearest_slot(position + before * lattice.voxels_per_texel);
      if (slot != TexelLattice<D>::inactive) return slot;
    }
    return lattice.nearest_slot(position);
  }

  const SceneTracer<D>& tracer_;
  const LightSampler<D>& lights_;
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces_;
  const SurfaceCache<D>& walls_;
  std::vector<Affine<D>> frame_to_texels_;
  std::vector<char> emissive_;
};

}  // namespace

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_path_estimator(const SceneTracer<D>& tracer,
                                                          const LightSampler<D>& lights,
                                                          const CausticPhotons<D>* photons) {
  return std::make_unique<PathEstimator<D>>(tracer, lights, photons);
}

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_gather_estimator(
    const SceneTracer<D>& tracer, const LightSampler<D>& lights,
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>& walls) {
  return std::make_unique<GatherEstimator<D>>(tracer, lights, isosurfaces, walls);
}

template <int D>
Rgb caustic_radiance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                     const SurfaceCache<D>* walls, const SurfacePoint<D>& point) {
  const Rgb brdf = point.albedo / static_cast<Real>(projected_hemisphere<D>);
  if (point.kind() == HitKind::mesh) return brdf * walls->caustic_irradiance(point);
  const IsosurfaceRadiance<D>& isosurface = isosurfaces[point.isosurface().volume];
  const std::int32_t slot =
      isosurface.lattice->nearest_slot(point.isosurface().cell_point.index_position());
  if (slot == TexelLattice<D>::inactive || !isosurface.photons) return Rgb(0);
  return brdf * isosurface.photons->caustic(slot, point.isosurface().back);
}

template std::unique_ptr<IndirectEstimator<2>> make_path_estimator(const SceneTracer<2>&,
                                                                   const LightSampler<2>&,
                                                                   const CausticPhotons<2>*);
template std::unique_ptr<IndirectEstimator<3>> make_path_estimator(const SceneTracer<3>&,
                                                                   const LightSampler<3>&,
                                                                   const CausticPhotons<3>*);
template std::unique_ptr<IndirectEstimator<2>> make_gather_estimator(
    const SceneTracer<2>&, const LightSampler<2>&, const std::vector<IsosurfaceRadiance<2>>&,
    const SurfaceCache<2>&);
template std::unique_ptr<IndirectEstimator<3>> make_gather_estimator(
    const SceneTracer<3>&, const LightSampler<3>&, const std::vector<IsosurfaceRadiance<3>>&,
    const SurfaceCache<3>&);
template Rgb caustic_radiance<2>(const std::vector<IsosurfaceRadiance<2>>&, const SurfaceCache<2>*,
                                 const SurfacePoint<2>&);
template Rgb caustic_radiance<3>(const std::vector<IsosurfaceRadiance<3>>&, const SurfaceCache<3>*,
                                 const SurfacePoint<3>&);

}  // namespace leaflight
