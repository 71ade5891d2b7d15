// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/indirect_estimator.h"

#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

// Light from below the traced surface does not arrive, whatever the shading normal says.
bool leaves_surface(const SurfacePoint& point, const Vec3& direction) {
  return direction.dot(point.geometric_normal) > 0;
}

class PathEstimator final : public IndirectEstimator {
 public:
  PathEstimator(const SceneTracer& tracer, const LightSampler& lights)
      : tracer_(tracer), lights_(lights) {}

  Rgb indirect_radiance(const SurfacePoint& start, const std::array<double, 2>& u, Random& random,
                        std::uint64_t& rays) const override {
    SurfacePoint point = start;
    std::array<double, 2> sample = u;
    Rgb radiance(0), throughput(1);
    for (;;) {
      throughput *= point.albedo;
      const Real survival = std::min(Real(1), largest(throughput));
      if (!(random.uniform() < survival)) return radiance;
      throughput /= survival;
      const Vec3 direction = sample_cosine_hemisphere(point.shading_normal, sample);
      if (!leaves_surface(point, direction)) return radiance;
      ++rays;
      const Hit hit = tracer_.intersect(point, direction);
      if (hit.kind == HitKind::none) return radiance;
      point = tracer_.surface_point(hit, direction, point.isovalue);
      const double choice = random.uniform();
      const std::array<double, 2> on_light{random.uniform(), random.uniform()};
      radiance += throughput * lights_.direct_radiance(point, choice, on_light, rays);
      sample = {random.uniform(), random.uniform()};
    }
  }

 private:
  const SceneTracer& tracer_;
  const LightSampler& lights_;
};

class VolumetricEstimator final : public IndirectEstimator {
 public:
  VolumetricEstimator(const LeafCache& leaves, const TexelLattice& lattice)
      : leaves_(leaves), lattice_(lattice) {}

  Rgb indirect_radiance(const SurfacePoint& point, const std::array<double, 2>&, Random&,
                        std::uint64_t&) const override {
    const std::int32_t slot = lattice_.nearest_slot(point.cell_point.index_position());
    if (slot == TexelLattice::inactive) return Rgb(0);
    const Rgb irradiance = point.above ? leaves_.inner(slot) : leaves_.outer_indirect(slot);
    return irradiance * point.albedo / static_cast<Real>(pi);
  }

 private:
  const LeafCache& leaves_;
  const TexelLattice& lattice_;
};

class GatherEstimator final : public IndirectEstimator {
 public:
  GatherEstimator(const SceneTracer& tracer, const LeafCache& leaves,
                  const SurfaceCache& surroundings, const TexelLattice& lattice,
                  const std::vector<Rgb>& outer_direct)
      : tracer_(tracer), leaves_(leaves), surroundings_(surroundings), lattice_(lattice) {
    const Rgb brdf = tracer.scene().leaf_albedo / static_cast<Real>(pi);
    outer_.resize(outer_direct.size());
    for (std::size_t s = 0; s < outer_.size(); ++s) {
      outer_[s] = outer_direct[s] + brdf * leaves.outer_indirect(static_cast<std::int32_t>(s));
    }
  }

  Rgb indirect_radiance(const SurfacePoint& point, const std::array<double, 2>& u, Random&,
                        std::uint64_t& rays) const override {
    const Vec3 direction = sample_cosine_hemisphere(point.shading_normal, u);
    if (!leaves_surface(point, direction)) return Rgb(0);
    ++rays;
    const Hit hit = tracer_.intersect(point, direction);
    return point.albedo * incident(hit, direction, point.isovalue);
  }

 private:
  Rgb incident(const Hit& hit, const Vec3& direction, double isovalue) const {
    if (hit.kind == HitKind::none) return Rgb(0);
    if (hit.kind == HitKind::surroundings) {
      return surroundings_.radiance(hit.surroundings, direction, isovalue);
    }
    const std::int32_t slot = lattice_.nearest_slot(hit.leaf.point.index_position());
    if (slot == TexelLattice::inactive) return Rgb(0);
    if (!hit.leaf.from_above) return outer_[slot];
    return leaves_.inner(slot) * tracer_.scene().leaf_albedo / static_cast<Real>(pi);
  }

  const SceneTracer& tracer_;
  const LeafCache& leaves_;
  const SurfaceCache& surroundings_;
  const TexelLattice& lattice_;
  std::vector<Rgb> outer_;
};

}  // namespace

std::unique_ptr<IndirectEstimator> make_path_estimator(const SceneTracer& tracer,
                                                       const LightSampler& lights) {
  return std::make_unique<PathEstimator>(tracer, lights);
}

std::unique_ptr<IndirectEstimator> make_volumetric_estimator(const LeafCache& leaves,
                                                             const TexelLattice& lattice) {
  return std::make_unique<VolumetricEstimator>(leaves, lattice);
}

std::unique_ptr<IndirectEstimator> make_gather_estimator(const SceneTracer& tracer,
                                                         const LeafCache& leaves,
                                                         const SurfaceCache& surroundings,
                                                         const TexelLattice& lattice,
                                                         const std::vector<Rgb>& outer_direct) {
  return std::make_unique<GatherEstimator>(tracer, leaves, surroundings, lattice, outer_direct);
}

}  // namespace leaflight
